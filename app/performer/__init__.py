"""The virtual performer: a synthetic person in front of a synthetic webcam, with its truth.

| module | what it does |
|---|---|
| `curves` | timing curves: minimum jerk, pulses, wandering, saccades, blinks |
| `acts` | what a person does on purpose: speak, turn, shake the head, pull faces |
| `takes` | acts joined, with blinks, gaze and sway added -> `Take` |
| `prompts` | the setup session: every prompted pose, done as people do it |
"""
