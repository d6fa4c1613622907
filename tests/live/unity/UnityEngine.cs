// What the package in clients/unity uses of Unity: its signatures, and as much behaviour as a scene without pictures needs.

using System;

namespace UnityEngine
{
    public struct Vector3
    {
        public float x, y, z;

        public Vector3(float x, float y, float z)
        {
            this.x = x;
            this.y = y;
            this.z = z;
        }
    }

    public struct Quaternion
    {
        /// <summary>Angles in degrees: around z, then x, then y, each clockwise seen along its axis (left-handed).</summary>
        public Vector3 euler;

        public static Quaternion Euler(float x, float y, float z)
        {
            return new Quaternion { euler = new Vector3(x, y, z) };
        }

        /// <summary>Where the z axis points.</summary>
        public Vector3 Forward
        {
            get
            {
                double pitch = euler.x * Math.PI / 180.0, yaw = euler.y * Math.PI / 180.0;
                double flat = Math.Cos(pitch);
                return new Vector3((float)(flat * Math.Sin(yaw)), (float)-Math.Sin(pitch), (float)(flat * Math.Cos(yaw)));
            }
        }
    }

    public class Transform
    {
        public Vector3 position, localScale = new Vector3(1, 1, 1);
        public Quaternion rotation;
        public Transform parent;

        public Vector3 forward { get { return rotation.Forward; } }
    }

    public class Object
    {
        public bool isDestroyed;

        public static void Destroy(Object which)
        {
            which.isDestroyed = true;
        }

        public static GameObject Instantiate(GameObject which)
        {
            return new GameObject { name = which.name + "(Clone)" };
        }
    }

    public enum PrimitiveType
    {
        Cube,
    }

    public class GameObject : Object
    {
        public string name = "";
        public Transform transform = new Transform();

        public static GameObject CreatePrimitive(PrimitiveType kind)
        {
            return new GameObject { name = kind.ToString() };
        }
    }

    public class MonoBehaviour : Object
    {
        public Transform transform = new Transform();
    }

    public static class Physics
    {
        public static bool autoSimulation = true;
    }
}
