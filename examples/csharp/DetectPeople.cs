// People in a picture of depth, as examples/detect_people.c:
// DetectPeople.exe MODEL|- DEPTH WIDTH HEIGHT FX FY CX CY

using System;
using System.Globalization;
using System.IO;
using Vesalius;

static class DetectPeople
{
    static float Number(string text) { return float.Parse(text, CultureInfo.InvariantCulture); }

    static long Millimetres(float metres) { return (long)Math.Round((double)metres * 1000.0, MidpointRounding.AwayFromZero); }

    static ushort[] ReadDepth(string path)
    {
        var bytes = File.ReadAllBytes(path);
        var depth = new ushort[bytes.Length / 2];
        Buffer.BlockCopy(bytes, 0, depth, 0, depth.Length * 2);
        return depth;
    }

    static void Run(string[] args)
    {
        var camera = new Camera(int.Parse(args[2]), int.Parse(args[3]), Number(args[4]), Number(args[5]), Number(args[6]), Number(args[7]));
        using (var detector = new Detector(args[0] == "-" ? null : args[0]))
        using (var people = detector.Detect(new Frame(ReadDepth(args[1])), camera))
        {
            for (int i = 0; i < people.Count; ++i)
            {
                var person = people[i];
                Console.WriteLine("person {0}: score {1}/1000, box {2} {3} {4} {5}", i, Millimetres(person.Score), person.BoxU, person.BoxV, person.BoxWidth, person.BoxHeight);
                var joints = person.Joints();
                for (int j = 0; j < joints.Length; ++j)
                {
                    if (joints[j].State == JointState.None) continue;
                    Console.WriteLine("  {0}: {1} {2} {3} mm", detector.JointNames()[j], Millimetres(joints[j].X), Millimetres(joints[j].Y), Millimetres(joints[j].Z));
                }
            }
        }
    }

    static int Main(string[] args)
    {
        if (args.Length != 8)
        {
            Console.Error.WriteLine("usage: DetectPeople.exe MODEL|- DEPTH WIDTH HEIGHT FX FY CX CY");
            return 2;
        }
        try
        {
            Run(args);
            return 0;
        }
        catch (Exception error)
        {
            Console.Error.WriteLine("DetectPeople: " + error.Message);
            return 1;
        }
    }
}
