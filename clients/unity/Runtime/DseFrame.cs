// Between the axes of dse (x east, y north, z up, right-handed) and Unity (y up, left-handed).

using System;
using UnityEngine;

namespace DseUdp
{
    /// <summary>
    /// A road that `dse export mesh` wrote, and Unity imported as .obj or .glb, is at the same places: these files have
    /// y up, and both importers negate x.
    /// </summary>
    public static class DseFrame
    {
        /// <summary>A place in m.</summary>
        public static Vector3 Position(double x, double y, double z)
        {
            return new Vector3((float)-x, (float)z, (float)-y);
        }

        /// <summary>An orientation: heading counter-clockwise from x, pitch > 0 nose down, roll > 0 left side up, in rad.</summary>
        public static Quaternion Rotation(double heading, double pitch = 0.0, double roll = 0.0)
        {
            return Quaternion.Euler(Degrees(pitch), -90f - Degrees(heading), -Degrees(roll));
        }

        /// <summary>The heading in rad of a transform that looks along its z axis.</summary>
        public static double Heading(Vector3 forward)
        {
            return Math.Atan2(-forward.z, -forward.x);
        }

        static float Degrees(double angle)
        {
            return (float)(angle * 180.0 / Math.PI);
        }
    }
}
