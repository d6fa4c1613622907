// Road users as objects of a scene: one for each place that is taken, of the prefab for its class.

using UnityEngine;

namespace DseUdp
{
    /// <summary>Places and hides road users. A class without a prefab is a box of its size.</summary>
    public sealed class DseMovers : MonoBehaviour
    {
        /// <summary>By the items of `actor_class`: none, car, truck, motorcycle, bicycle, pedestrian, obstacle.</summary>
        public GameObject[] prefabs = new GameObject[7];

        GameObject[] shown = new GameObject[0];
        int[] classes = new int[0];

        /// <summary>Show what is at a place, or nothing if kind is 0. Size: width, height, length in m; x, y, z in m of the road below its middle.</summary>
        public void Show(int place, int kind, Vector3 size, double x, double y, double z, double heading)
        {
            if (place >= shown.Length)
            {
                System.Array.Resize(ref shown, place + 1);
                System.Array.Resize(ref classes, place + 1);
            }
            if (classes[place] != kind && shown[place] != null)
            {
                Destroy(shown[place]);
                shown[place] = null;
            }
            classes[place] = kind;
            if (kind == 0) return;
            bool isBox = kind >= prefabs.Length || prefabs[kind] == null;
            if (shown[place] == null)
            {
                shown[place] = isBox ? GameObject.CreatePrimitive(PrimitiveType.Cube) : Instantiate(prefabs[kind]);
                shown[place].transform.parent = transform;
            }
            // The middle of a box is half its height above the road; a prefab has its origin on the road.
            Transform at = shown[place].transform;
            at.position = DseFrame.Position(x, y, isBox ? z + 0.5 * size.y : z);
            at.rotation = DseFrame.Rotation(heading);
            if (isBox) at.localScale = size;
        }
    }
}
