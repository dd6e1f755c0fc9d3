"""A user's own face: the skin's texture and the colours, from the pictures of the setup.

| module | what it does |
|---|---|
| `make` | `make_likeness`: pictures and fit in, `Likeness` out; falls back to colours alone |
| `judge` | whether the texture explains the pictures better than painted skin |
| `colors` | colours of hair and eyes; how the hair is cut |
| `tone` | parts the colour of skin from the colour of the light |
| `blend` | joins the pictures' colours in texture space, and painted skin where none looks |
| `ground` | the masks and texels that all pictures are laid on |
| `glasses` | leaves out what the rims of glasses hide |
| `surroundings` | smooth functions on the head's mesh, which knows no seams of the texture |
| `light` | the light of the pictures, divided out |
| `views` | what one picture shows of the head, texel by texel |
| `choice` | which pictures are used |
| `atlas` | where on the head each texel lies |
"""
