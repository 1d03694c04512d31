// Stands for Unity where examples/unity is compiled and run in a test: those of its types that the example uses, with what
// the test looks at afterwards. It is no part of Unity and shows nothing.

using System;
using System.Collections.Generic;

namespace UnityEngine
{
    public struct Vector3
    {
        public float x, y, z;
        public Vector3(float x, float y, float z) { this.x = x; this.y = y; this.z = z; }
    }

    public class Object
    {
        public static void Destroy(Object gone) { GameObject.All.Remove(gone as GameObject); }
    }

    public class Component : Object
    {
        public Transform transform = null;
    }

    public class Transform : Component
    {
        public Vector3 localPosition, localScale;
        public Transform parent;
        public void SetParent(Transform parent, bool worldPositionStays) { this.parent = parent; }
    }

    public enum PrimitiveType { Sphere = 0 }

    public class GameObject : Object
    {
        public static readonly List<GameObject> All = new List<GameObject>();
        public readonly Transform transform = new Transform();
        public bool activeSelf = true;
        public void SetActive(bool active) { activeSelf = active; }
        public static GameObject CreatePrimitive(PrimitiveType type)
        {
            All.Add(new GameObject());
            return All[All.Count - 1];
        }
    }

    public class Behaviour : Component { }
    public class MonoBehaviour : Behaviour { }

    // Unity has these names too: an example that takes one for vesalius' does not compile.
    public class Camera : Behaviour { }
    public class Joint : Component { }

    [AttributeUsage(AttributeTargets.Field)]
    public sealed class SerializeField : Attribute { }

    public static class Debug
    {
        public static string LastError;
        public static void LogError(object message) { LastError = message.ToString(); }
    }

    public static class Application
    {
        public static string streamingAssetsPath;
    }
}
