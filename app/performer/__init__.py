"""The virtual performer: a synthetic person in front of a synthetic webcam, with its truth.

`open_performer(Scenario(take="talking"))` is a FrameSource whose `truth(index)` tells what is
really there; `setup_pictures()` gives the 60 prompted poses.

| module | what it does |
|---|---|
| `opening` | names -> a performance |
| `performer` | the FrameSource: frames by the clock or by number, motion blur, truth |
| `truth` | take + person -> pose, expression, gaze and 77 points at any time |
| `stage` | draws the person in the room with app.render; clean pictures |
| `sensor` | clean picture -> webcam picture: softness, exposure, noise, compression |
| `people` | who performs; none is in the face model's span |
| `posture` | head angles -> where head and body are |
| `takes`, `acts`, `measured`, `curves` | what is done when |
| `prompts` | the setup session, done as people do it |
| `conditions` | what makes a face harder to follow: worn or held things, bad light |
| `props` | those things placed in each picture: `glasses`, `hand`, `microphone`, `cap`, `growth` |
| `shapes` | meshes of things: tubes, turned bodies, surfaces of fields |
| `room`, `lights`, `pacing` | the set, the lamps, the clock |
"""
