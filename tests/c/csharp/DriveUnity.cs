// Calls the component of examples/unity as Unity would, with one picture: DriveUnity.exe MODELS DEPTH WIDTH HEIGHT FX FY CX CY
// Prints the joints' spheres as examples/detect_people.c prints joints.

using System;
using System.Globalization;
using System.IO;
using System.Reflection;
using System.Threading;
using UnityEngine;

static class DriveUnity
{
    static void Send(object component, string message)
    {
        component.GetType().GetMethod(message, BindingFlags.Instance | BindingFlags.NonPublic).Invoke(component, null);
    }

    static float Number(string text) { return float.Parse(text, CultureInfo.InvariantCulture); }

    static void Follow(VesaliusPeople component, ushort[] depth, Vesalius.Camera camera, double time)
    {
        var before = component.People;
        if (!component.Submit(depth, camera, time)) throw new Exception("expected to take the picture");
        for (int i = 0; i < 2000 && ReferenceEquals(component.People, before) && Debug.LastError == null; ++i)
        {
            Thread.Sleep(10);
            Send(component, "Update");
        }
        if (Debug.LastError != null) throw new Exception(Debug.LastError);
    }

    static int Shown()
    {
        int shown = 0;
        foreach (var sphere in GameObject.All) shown += sphere.activeSelf ? 1 : 0;
        return shown;
    }

    static void Main(string[] args)
    {
        Application.streamingAssetsPath = args[0];
        var bytes = File.ReadAllBytes(args[1]);
        var depth = new ushort[bytes.Length / 2];
        Buffer.BlockCopy(bytes, 0, depth, 0, bytes.Length);
        var camera = new Vesalius.Camera(int.Parse(args[2]), int.Parse(args[3]), Number(args[4]), Number(args[5]), Number(args[6]), Number(args[7]));
        var component = new VesaliusPeople();
        Send(component, "Awake");
        for (int i = 0; i < 3; ++i) Follow(component, depth, camera, i / 30.0);
        Console.WriteLine("people {0}, spheres {1}, shown {2}", component.People.Count, GameObject.All.Count, Shown());
        foreach (var person in component.People)
        {
            if (person.State != Vesalius.PersonState.Tracked) throw new Exception("expected to be tracked: " + person.State);
            var head = person.Joints[26];
            Console.WriteLine("person {0}: head {1}", person.Id, head.Z > 0.3f && head.Z < 8f ? "in the room" : "elsewhere");
        }
        // Who is lost leaves no spheres.
        Follow(component, new ushort[depth.Length], camera, 1);
        Follow(component, new ushort[depth.Length], camera, 100);
        Follow(component, new ushort[depth.Length], camera, 100.1);
        Console.WriteLine("people {0}, spheres {1}", component.People.Count, GameObject.All.Count);
        Send(component, "OnDestroy");
    }
}
