// Prints how C# lays out the structures of examples/csharp/Vesalius.cs, as layouts.c prints those of vesalius.h.

using System;
using System.Reflection;
using System.Runtime.InteropServices;
using Vesalius;

static class Layouts
{
    static void Print(string name, Type type)
    {
        Console.Write("{0} {1}:", name, Marshal.SizeOf(type));
        foreach (var field in type.GetFields(BindingFlags.Instance | BindingFlags.Public | BindingFlags.NonPublic))
            Console.Write(" {0}", Marshal.OffsetOf(type, field.Name));
        Console.WriteLine();
    }

    static void Main()
    {
        Print("option", typeof(Native.Option));
        Print("camera", typeof(Native.Camera));
        Print("frame", typeof(Native.Frame));
        Print("person", typeof(Native.Person));
        Print("joint", typeof(Joint));
        Print("part", typeof(Part));
        Print("unseen", typeof(Unseen));
        Print("bone", typeof(Bone));
        Print("rotation", typeof(Rotation));
    }
}
