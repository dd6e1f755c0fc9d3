"""Draws heads and scenes with OpenGL, offscreen, into arrays. Knows no Qt and no file formats.

| module | what it does |
|---|---|
| `scene` | what can be drawn: `Mesh`, `Material`, `Lights`, `View` (exact pinhole camera) |
| `renderer` | `Renderer`: owns the context: `upload`, `draw` a `Scene`, `depth_mm` |
| `context`, `programs`, `target`, `drawable` | its parts: context, shaders, framebuffer, buffers |
| `avatar` | `Avatar`: shapes, parts and eyes of a head that can be posed |
| `puppet` | `Puppet`: morphs an avatar, turns its eyes, bends its neck, gives the items to draw |
| `eyeball` | the eyes' mesh and the rotation of a gaze |
| `thinning` | leaves out triangles that nobody sees, where the processor draws |
| `thread` | `RenderThread`: a renderer in a thread of its own, always the newest wish |
| `look` | `AvatarLook`: what the user may choose: orbit, zoom, framing, background, lights |
| `lights`, `backdrop` | the lights and backgrounds to choose from |
| `quality` | `Ladder`: draws smaller where pictures take too long, and larger again later |

To draw anything, in one thread from making to releasing:

    renderer = Renderer()
    drawable = renderer.upload(Mesh(...), Material("plain", texture))
    item = Item(drawable, placed(rotation, translation_mm), body_to_camera)
    scene = Scene(View(camera), studio_lights(), [item, *puppet.items(...)], backdrop_rgb)
    picture = renderer.draw(scene)      # (H, W, 4) uint8, premultiplied alpha
    depth = renderer.depth_mm(scene)    # (H, W) float32, a second pass
    drawable.move(vertices_and_normals) # (V, 6), before the next picture

Everything is in the model frame (x to the subject's left, y down, z into the head, mm) and put
into the camera frame (x right, y down, z forward) by the item. `View.camera` is exact: a point at
`core.camera.project(camera, point)` is drawn at that pixel. Lights stay with the camera.

The materials, each a fragment shader of the same name; `scene.DEFAULTS` has their values:

| shader | texture | for |
|---|---|---|
| `skin` | colour, alpha = oiliness | skin: light wraps round, red furthest |
| `eye` | front view of an eyeball | only through `Puppet` |
| `hair` | colour, alpha = coverage | strands that run away from `whorl`; `cutoff`, `shine` |
| `wet` | colour | teeth and tongue; `gloss`, `lit` |
| `plain` | colour | cloth, caps, anything dull |

A machine without a graphics card draws in software: no multisampling there, but edges are
smoothed afterwards, and `View(supersampling=2)` makes clean stills and films at three times the
cost.
"""
