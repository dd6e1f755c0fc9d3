"""The papers' experiments: each module is one study that `facepuppet study` runs.

A study has HELP, `add_options(parser)` and `run(args, models)`, a generator that returns a Report.

| module | what it asks |
|---|---|
| `pose` | how well the head's pose is found on the performer's head-motion takes |
| `bu` | the same on the Boston University films, for those who have them |
| `iterations` | what more iterations of the paper's solver cost and bring |
| `solvers` | the paper's solver against ours |
| `conditions` | glasses, beard, hair, a hand, dim light, one-sided faces; real films |
| `still` | how much the track of a still face shakes |
| `film` | what the landmark network sees of a film, once for all trackers |
| `solving` | the solvers alone, on what was seen |
| `measures` | errors of pose, landmarks and coefficients |
| `bu_format` | the files of the Boston University database |
| `report` | tables as text and as JSON |
"""
