"""The 75-landmark scheme: names, groups, mirror images, and its maps to other schemes.

Landmarks 0..59 are internal features; 60..74 lie on the outline of the face, from the subject's
right ear (R1) over the chin to the left ear (L1), and stand for no fixed vertex [Cao13, sec. 3].
A 3D shape has 77 points: the internal landmarks, 15 fixed vertices that replace the outline, and
the pupils (right, left). R_ and L_ are the subject's sides.

Vertex numbers here count in the 4177-vertex head crop of the base mesh: the faces of its body
whose weight on the head, jaw, face and neck bones exceeds a half, vertices in the mesh's order.
"""

from collections.abc import Sequence

import numpy as np

from core.records import I32

# Name, index in the 478-point network, in the iBUG 68 scheme (-1: not there), vertex.
_INTERNAL: tuple[tuple[str, int, int, int], ...] = (
    ("R_brow_1", 70, 17, 261),
    ("L_brow_1", 300, 26, 2388),
    ("R_brow_2", 63, 18, 225),
    ("L_brow_2", 293, 25, 2357),
    ("R_brow_3", 105, 19, 224),
    ("L_brow_3", 334, 24, 2356),
    ("R_brow_4", 66, 20, 205),
    ("L_brow_4", 296, 23, 2338),
    ("R_brow_5", 107, 21, 208),
    ("L_brow_5", 336, 22, 2341),
    ("R_brow_6_lower_inner", 55, -1, 209),
    ("L_brow_6_lower_inner", 285, -1, 2342),
    ("R_eye_outer", 33, 36, 18),
    ("L_eye_outer", 263, 45, 2160),
    ("R_eye_up_outer", 160, 37, 6),
    ("L_eye_up_outer", 387, 44, 2148),
    ("R_eye_up_mid", 159, -1, 0),
    ("L_eye_up_mid", 386, -1, 2142),
    ("R_eye_up_inner", 158, 38, 54),
    ("L_eye_up_inner", 385, 43, 2196),
    ("R_eye_inner", 133, 39, 66),
    ("L_eye_inner", 362, 42, 2208),
    ("R_eye_lo_inner", 153, 40, 47),
    ("L_eye_lo_inner", 380, 47, 2189),
    ("R_eye_lo_mid", 145, -1, 44),
    ("L_eye_lo_mid", 374, -1, 2186),
    ("R_eye_lo_outer", 144, 41, 41),
    ("L_eye_lo_outer", 373, 46, 2183),
    ("nose_bridge_1", 168, 27, 132),
    ("nose_bridge_2", 6, 28, 135),
    ("nose_bridge_3", 195, -1, 1406),
    ("nose_bridge_4", 5, 29, 201),
    ("nose_tip", 1, 30, 297),
    ("subnasale", 2, 33, 312),
    ("R_nostril_base", 97, 32, 313),
    ("L_nostril_base", 326, 34, 2434),
    ("R_nostril_wing_base", 98, 31, 286),
    ("L_nostril_wing_base", 327, 35, 2413),
    ("R_ala", 129, -1, 1394),
    ("L_ala", 358, -1, 3450),
    ("lip_up_mid", 0, 51, 466),
    ("lip_lo_mid", 17, 57, 496),
    ("lipin_up_mid", 13, 62, 474),
    ("lipin_lo_mid", 14, 66, 523),
    ("R_mouth_corner", 61, 48, 431),
    ("L_mouth_corner", 291, 54, 2549),
    ("R_lip_up_outer", 40, 49, 411),
    ("L_lip_up_outer", 270, 53, 2529),
    ("R_lip_up_peak", 37, 50, 456),
    ("L_lip_up_peak", 267, 52, 2573),
    ("R_lip_lo_outer", 146, 59, 439),
    ("L_lip_lo_outer", 375, 55, 2557),
    ("R_lip_lo_inner", 84, 58, 490),
    ("L_lip_lo_inner", 314, 56, 2603),
    ("R_lipin_corner", 78, 60, 430),
    ("L_lipin_corner", 308, 64, 2548),
    ("R_lipin_up", 82, 61, 472),
    ("L_lipin_up", 312, 63, 2586),
    ("R_lipin_lo", 87, 67, 517),
    ("L_lipin_lo", 317, 65, 2622),
)

# Name, where its line over the face starts and ends in the 478-point network, and its strip of
# vertices; both from the inside of the face outwards. The lines end at those points of the
# network's own face oval that lie where the strips cross the outline of a frontal head.
_CONTOUR: tuple[tuple[str, int, int, tuple[int, ...]], ...] = (
    ("R1", 35, 127,
     (102, 1027, 994, 1245, 989, 148, 194, 1530, 1329, 1538, 267, 1580, 807, 1745, 2112, 2081)),
    ("R2", 101, 234,
     (1401, 1403, 192, 213, 839, 1518, 1669, 1525, 1526, 269, 1578, 805, 796, 2078, 1798)),
    ("R3", 36, 93,
     (1482, 1418, 1411, 1674, 1676, 1494, 1495, 1497, 1548, 270, 1581, 806, 1440, 803, 2095)),
    ("R4", 216, 132, (1601, 837, 1631, 1632, 1644, 1551, 1549, 736, 1585, 849, 848, 738)),
    ("R5", 212, 58, (711, 1487, 1498, 1516, 1642, 1583, 832, 739, 931)),
    ("R6", 202, 172,
     (442, 404, 1289, 1506, 1570, 1641, 852, 829, 830, 741, 933, 935, 753, 754, 756)),
    ("R7", 204, 150, (480, 721, 734, 1553, 1508, 1637, 859, 743)),
    ("chin", 17, 152, (492, 1680, 491, 724, 733, 1505, 1554, 1514, 1568, 1639, 732, 747, 762, 925)),
    ("L7", 424, 379, (2593, 2802, 2812, 3602, 3559, 3681, 2926, 2821)),
    ("L6", 422, 397,
     (2560, 2522, 3346, 3557, 3617, 3684, 2919, 2896, 2897, 2819, 2992, 2994, 2830, 2831, 2833)),
    ("L5", 432, 288, (2792, 3539, 3550, 3566, 3685, 3630, 2899, 2817, 2990)),
    ("L4", 436, 361, (3647, 2904, 3675, 3676, 3687, 3600, 3598, 2814, 3632, 2916, 2915, 2816)),
    ("L3", 266, 323,
     (3534, 3471, 3465, 3716, 3718, 3546, 3547, 3549, 3597, 2397, 3628, 2876, 3493, 2873, 4130)),
    ("L2", 330, 454,
     (3456, 3458, 2326, 2346, 2906, 3568, 3711, 3575, 3576, 2396, 3625, 2875, 2866, 4113, 3835)),
    ("L1", 265, 356,
     (2244, 3084, 3051, 3302, 3046, 2284, 2328, 3580, 3386, 3587, 2394, 3627, 2877, 3782, 4147,
      4116)),
)  # fmt: skip

# The fixed vertices that replace the outline in 3D shapes [Cao13, sec. 3]. They cover the skin
# between the features, stay inside the outline to 30 degrees of yaw, and move with jaw and cheeks.
_REPLACEMENTS: tuple[tuple[str, int], ...] = (
    ("R_forehead", 1608),
    ("L_forehead", 3654),
    ("R_temple", 216),
    ("L_temple", 2349),
    ("R_nose_side", 844),
    ("L_nose_side", 2911),
    ("R_cheekbone", 213),
    ("L_cheekbone", 2346),
    ("R_cheek", 1674),
    ("L_cheek", 3716),
    ("R_jaw", 1517),
    ("L_jaw", 3567),
    ("R_chin_side", 734),
    ("L_chin_side", 2812),
    ("chin_front", 733),
)

# Delaunay triangles of the 77 points seen from the front with the mouth drawn 10 mm open (closed
# lips would leave triangles of no area and cut others across the lips), without the hull's
# slivers below 6 degrees. Corners turn clockwise in the image.
_TRIANGLES: tuple[tuple[int, int, int], ...] = (
    (0, 2, 12), (0, 12, 62), (1, 13, 3), (1, 63, 13), (2, 4, 14), (2, 14, 12), (3, 13, 15),
    (3, 15, 5), (4, 6, 16), (4, 16, 14), (4, 60, 6), (5, 7, 61), (5, 15, 17), (5, 17, 7),
    (6, 8, 18), (6, 18, 16), (6, 60, 8), (7, 9, 61), (7, 17, 19), (7, 19, 9), (8, 9, 28),
    (8, 10, 18), (8, 28, 10), (8, 60, 61), (8, 61, 9), (9, 11, 28), (9, 19, 11), (10, 20, 18),
    (10, 28, 29), (10, 29, 20), (11, 19, 21), (11, 21, 29), (11, 29, 28), (12, 14, 26),
    (12, 26, 66), (12, 66, 62), (13, 27, 15), (13, 63, 67), (13, 67, 27), (14, 16, 75),
    (14, 75, 26), (15, 27, 76), (15, 76, 17), (16, 18, 75), (17, 76, 19), (18, 20, 22),
    (18, 22, 75), (19, 23, 21), (19, 76, 23), (20, 29, 30), (20, 30, 64), (20, 64, 22),
    (21, 23, 65), (21, 30, 29), (21, 65, 30), (22, 24, 75), (22, 64, 24), (23, 25, 65),
    (23, 76, 25), (24, 26, 75), (24, 64, 66), (24, 66, 26), (25, 27, 67), (25, 67, 65),
    (25, 76, 27), (30, 31, 64), (30, 65, 31), (31, 32, 64), (31, 65, 32), (32, 33, 34),
    (32, 34, 36), (32, 35, 33), (32, 36, 38), (32, 37, 35), (32, 38, 64), (32, 39, 37),
    (32, 65, 39), (33, 35, 49), (33, 40, 48), (33, 48, 34), (33, 49, 40), (34, 48, 36),
    (35, 37, 49), (36, 46, 38), (36, 48, 46), (37, 39, 47), (37, 47, 49), (38, 46, 68),
    (38, 68, 64), (39, 65, 69), (39, 69, 47), (40, 42, 56), (40, 49, 57), (40, 56, 48),
    (40, 57, 42), (41, 43, 53), (41, 52, 43), (41, 53, 74), (41, 74, 52), (42, 43, 58),
    (42, 57, 59), (42, 58, 56), (42, 59, 43), (43, 52, 58), (43, 59, 53), (44, 46, 54),
    (44, 50, 70), (44, 54, 50), (44, 70, 46), (45, 47, 71), (45, 51, 55), (45, 55, 47),
    (45, 71, 51), (46, 48, 56), (46, 56, 54), (46, 70, 68), (47, 55, 57), (47, 57, 49),
    (47, 69, 71), (50, 52, 72), (50, 54, 58), (50, 58, 52), (50, 72, 70), (51, 53, 59),
    (51, 59, 55), (51, 71, 73), (51, 73, 53), (52, 74, 72), (53, 73, 74), (54, 56, 58),
    (55, 59, 57), (64, 68, 66), (65, 67, 69), (66, 68, 70), (67, 71, 69),
)  # fmt: skip


def _table(rows: object) -> I32:
    table = np.array(rows, np.int32)
    table.setflags(write=False)
    return table


def _mirror(names: Sequence[str]) -> I32:
    """Return for each name the index of the name on the other side."""
    swap = {"R": "L", "L": "R"}
    other = [swap.get(name[0], name[0]) + name[1:] for name in names]
    return _table([names.index(name) for name in other])


N_INTERNAL = len(_INTERNAL)
N_LANDMARKS = N_INTERNAL + len(_CONTOUR)

NAMES: tuple[str, ...] = (
    *(row[0] for row in _INTERNAL),
    *(row[0] for row in _CONTOUR),
)
SHAPE_NAMES: tuple[str, ...] = (
    *(row[0] for row in _INTERNAL),
    *(row[0] for row in _REPLACEMENTS),
    "R_pupil",
    "L_pupil",
)
N_SHAPE_POINTS = len(SHAPE_NAMES)

#: (75,) index in the 478-point network of each landmark.
MESH478: I32 = _table([row[1] for row in _INTERNAL] + [row[2] for row in _CONTOUR])
#: (15,) index in the 478-point network of the inner end of each outline landmark's line.
CONTOUR_STARTS478: I32 = _table([row[1] for row in _CONTOUR])
#: (2,) index in the 478-point network of the iris centres, right then left.
PUPILS478: I32 = _table([468, 473])
#: (75,) index in the iBUG 68 scheme, -1 where it has no such point. Of its 17 outline points
#: only the chin is also one of our 15.
TO_IBUG68: I32 = _table(
    [row[2] for row in _INTERNAL] + [8 if r[0] == "chin" else -1 for r in _CONTOUR]
)
#: (68,) our landmark for each iBUG point, -1 where we have none.
IBUG68: I32 = _table([list(TO_IBUG68).index(i) if i in TO_IBUG68 else -1 for i in range(68)])
#: (75,) and (77,) index of each point's mirror image.
MIRROR: I32 = _mirror(NAMES)
SHAPE_MIRROR: I32 = _mirror(SHAPE_NAMES)

#: (60,) and (15,) vertices of the head crop, and the 15 strips.
INTERNAL_HEAD_VERTICES: I32 = _table([row[3] for row in _INTERNAL])
REPLACEMENT_HEAD_VERTICES: I32 = _table([row[1] for row in _REPLACEMENTS])
CONTOUR_HEAD_STRIPS: tuple[tuple[int, ...], ...] = tuple(row[3] for row in _CONTOUR)

#: (M, 3) triangles over the 77 shape points.
SHAPE_TRIANGLES: I32 = _table(_TRIANGLES)


def _indices(*names: str) -> tuple[int, ...]:
    return tuple(NAMES.index(name) for name in names)


def _sided(side: str, *names: str) -> tuple[int, ...]:
    return _indices(*(f"{side}_{name}" for name in names))


_BROW = ("brow_1", "brow_2", "brow_3", "brow_4", "brow_5", "brow_6_lower_inner")
_EYE = (
    "eye_outer", "eye_up_outer", "eye_up_mid", "eye_up_inner",
    "eye_inner", "eye_lo_inner", "eye_lo_mid", "eye_lo_outer",
)  # fmt: skip
_BRIDGE = _indices("nose_bridge_1", "nose_bridge_2", "nose_bridge_3", "nose_bridge_4", "nose_tip")
_NOSE_BASE = (
    *_sided("R", "ala", "nostril_wing_base", "nostril_base"),
    *_indices("subnasale"),
    *_sided("L", "nostril_base", "nostril_wing_base", "ala"),
)
_LIPS_OUTER = (
    *_sided("R", "mouth_corner", "lip_up_outer", "lip_up_peak"),
    *_indices("lip_up_mid"),
    *_sided("L", "lip_up_peak", "lip_up_outer", "mouth_corner", "lip_lo_outer", "lip_lo_inner"),
    *_indices("lip_lo_mid"),
    *_sided("R", "lip_lo_inner", "lip_lo_outer"),
)
_LIPS_INNER = (
    *_sided("R", "lipin_corner", "lipin_up"),
    *_indices("lipin_up_mid"),
    *_sided("L", "lipin_up", "lipin_corner", "lipin_lo"),
    *_indices("lipin_lo_mid"),
    *_sided("R", "lipin_lo"),
)

#: Landmarks of each feature, in drawing order.
GROUPS: dict[str, tuple[int, ...]] = {
    "brow_right": _sided("R", *_BROW),
    "brow_left": _sided("L", *_BROW),
    "eye_right": _sided("R", *_EYE),
    "eye_left": _sided("L", *_EYE),
    "nose": _BRIDGE + _NOSE_BASE,
    "lips_outer": _LIPS_OUTER,
    "lips_inner": _LIPS_INNER,
    "contour": tuple(range(N_INTERNAL, N_LANDMARKS)),
}

#: Polylines to draw a face with; closed ones repeat their first landmark.
CURVES: tuple[tuple[int, ...], ...] = (
    GROUPS["brow_right"],
    GROUPS["brow_left"],
    *(GROUPS[name] + GROUPS[name][:1] for name in ("eye_right", "eye_left")),
    _BRIDGE,
    _NOSE_BASE,
    *(GROUPS[name] + GROUPS[name][:1] for name in ("lips_outer", "lips_inner")),
    GROUPS["contour"],
)

#: The parts of a face that are trusted each by itself, in the order of `FaceState.regions`.
REGION_NAMES: tuple[str, ...] = ("brows", "eye_right", "eye_left", "nose", "mouth", "outline")
#: Landmarks of each of them.
REGION_LANDMARKS: tuple[tuple[int, ...], ...] = (
    GROUPS["brow_right"] + GROUPS["brow_left"],
    GROUPS["eye_right"],
    GROUPS["eye_left"],
    GROUPS["nose"],
    GROUPS["lips_outer"] + GROUPS["lips_inner"],
    GROUPS["contour"],
)
