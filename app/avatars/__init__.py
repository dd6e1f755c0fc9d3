"""The avatars: heads of the face model with skin, eyes, hair and a shirt.

| module | what it does |
|---|---|
| `gallery` | `Gallery`: the built-in avatars by name, and the user's own head |
| `views` | `portrait` and `overlay`: where head, body and camera are |
| `painter` | `AvatarPainter`: draws an `AvatarWish`; keeps avatars on the graphics card |
| `looks` | `Looks`: colours and amounts of one person; `LOOKS`, five tones, young and old |
| `build`, `assembly` | put the parts together |
| `likeness` | the user's own skin and colours, from the pictures of the setup |
| `characters`, `juno`, `fennec` | the drawn characters: proportions, skins, what they wear |
| `warp`, `pieces`, `drawn_eyes` | bend heads; make locks, ears, noses; draw eyes |
| `wardrobe` | what all avatars share, read from the shipped files |
| `complexion`, `small_textures` | mix and paint textures |
| `head`, `hair`, `hairline`, `bust` | the parts' geometry |
"""
