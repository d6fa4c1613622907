# Between the axes of dse (x east, y north, z up) and Godot (y up, forward is -z); both are right-handed.
# A road that `dse export mesh` wrote as .glb is at the same places.


# A place in m.
static func position(x, y, z):
	return Vector3(x, z, -y)


# Angles of a node: heading counter-clockwise from x, pitch > 0 nose down, roll > 0 left side up, in rad.
static func rotation(heading, pitch = 0.0, roll = 0.0):
	return Vector3(-pitch, heading - 0.5 * PI, -roll)


# The heading in rad of a node whose forward direction this is.
static func heading(forward):
	return atan2(-forward.z, forward.x)
