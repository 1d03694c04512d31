// Calls of examples/csharp/Vesalius.cs that the examples do not make: Binding.exe MODEL DEPTH WIDTH HEIGHT FX FY CX CY

using System;
using System.Globalization;
using System.IO;
using System.Linq;
using System.Threading;
using Vesalius;

static class Binding
{
    static void Expect(bool condition, string what)
    {
        if (!condition) throw new Exception("expected " + what);
    }

    static void ExpectError(Status status, string why, Action action)
    {
        try
        {
            action();
        }
        catch (VesaliusException error)
        {
            Expect(error.Status == status && error.Message.Contains(why), status + ", " + why + ", found " + error.Status + ", " + error.Message);
            return;
        }
        throw new Exception("expected an error: " + why);
    }

    static float Number(string text) { return float.Parse(text, CultureInfo.InvariantCulture); }

    static byte[] Everything(People people)
    {
        var bytes = new MemoryStream();
        var to = new BinaryWriter(bytes);
        for (int i = 0; i < people.Count; ++i)
        {
            foreach (var joint in people[i].Joints()) { to.Write(joint.X); to.Write(joint.Y); to.Write(joint.Z); }
            to.Write(people[i].Mask());
            to.Write(people[i].Labels());
        }
        return bytes.ToArray();
    }

    static void CheckPeople(Detector detector, People people)
    {
        Expect(people.Count > 0, "people");
        var person = people[0];
        var mask = person.Mask();
        var labels = person.Labels();
        var parts = person.Parts();
        Expect(mask.Length == people.Width * people.Height && mask.Max() == 1, "a mask");
        Expect(labels.Where(label => label != 255).All(label => label < detector.Parts.Length), "labels of parts");
        Expect(parts.Length == detector.Parts.Length, "all parts");
        Expect(parts.Where(part => part.State == JointState.Observed).All(part => part.Z > 0.3f && part.Extent0 >= part.Extent1), "parts in the room");
        Expect(float.IsNaN(person.VelocityX) && person.Id == 0 && person.State == PersonState.Seen, "what a detector tells");
        Expect(person.Bones().Length == 0 && float.IsNaN(person.Stature) && float.IsNaN(person.Rotations()[0].W), "no body from a detector");
        Expect(detector.JointSets.Contains("coco17") && person.Joints("coco17").Length == 17, "joints of COCO");
        var unseen = person.PartsUnseen();
        Expect(parts.Select((part, i) => (part.State == JointState.Observed) == (unseen[i].Why == UnseenReason.None)).All(same => same), "reasons of unseen parts");
        Expect(person.JointsUnseen().All(joint => (joint.Why == UnseenReason.BehindPerson) == (joint.Behind >= 0)), "who hides joints");
        ExpectError(Status.Argument, "joint set \"feet\"", () => person.Joints("feet"));
        ExpectError(Status.Argument, "joint set \"feet\"", () => detector.JointNames("feet"));
        ExpectError(Status.Argument, "is not there", () => Console.WriteLine(people[99]));
    }

    static void CheckBodies(Detector detector, ushort[] depth, Camera camera)
    {
        using (var tracker = new Tracker(detector))
        using (var people = tracker.Update(new Frame(depth), camera))
        {
            var person = people[0];
            var bones = person.Bones();
            Expect(person.Id > 0 && person.Stature > 1 && person.Stature < 2.2f, "a fitted body");
            Expect(bones.Length == detector.Bones.Length && bones.Length == detector.BoneParents.Length, "its bones");
            Expect(detector.BoneParents.Select((parent, i) => parent < i).All(earlier => earlier) && detector.BoneParents[0] == -1, "parents first");
            foreach (var bone in bones)
            {
                double length = Math.Sqrt(Math.Pow(bone.TailX - bone.HeadX, 2) + Math.Pow(bone.TailY - bone.HeadY, 2) + Math.Pow(bone.TailZ - bone.HeadZ, 2));
                double norm = Math.Pow(bone.RotationX, 2) + Math.Pow(bone.RotationY, 2) + Math.Pow(bone.RotationZ, 2) + Math.Pow(bone.RotationW, 2);
                Expect(Math.Abs(length - bone.Length) < 1e-3 && Math.Abs(norm - 1) < 1e-3, "ends and rotation of a bone");
            }
            Expect(person.Rotations().Any(rotation => !float.IsNaN(rotation.W)), "rotations of joints");
        }
    }

    static void CheckLayouts(Detector detector, ushort[] depth, Camera camera, byte[] expected)
    {
        int width = camera.Width;
        var turned = new ushort[depth.Length];
        for (int v = 0; v < camera.Height; ++v) Array.Copy(depth, v * width, turned, (camera.Height - 1 - v) * width, width);
        var metres = depth.Select(mm => mm == 0 ? float.NaN : mm * 0.001f).ToArray();
        var frames = new[] { new Frame(turned) { BottomUp = true }, new Frame(metres) };
        foreach (var frame in frames)
            using (var people = detector.Detect(frame, camera)) Expect(Everything(people).SequenceEqual(expected), "the same people");
        var colour = new byte[depth.Length * 4];
        using (var people = detector.Detect(new Frame(depth) { Colour = colour, ColourFormat = ColourFormat.Bgra, BottomUp = false }, camera))
            Expect(people.Count > 0, "people with colour");
        var bent = new Camera(camera.Width, camera.Height, camera.Fx, camera.Fy, camera.Cx, camera.Cy) { Lens = Lens.BrownConrady, Distortion = new[] { 0.1, -0.05 } };
        using (var people = detector.Detect(new Frame(depth), bent)) Expect(!Everything(people).SequenceEqual(expected), "a lens to matter");
    }

    static void CheckThreads(Detector detector, ushort[] depth, Camera camera, byte[] expected)
    {
        int same = 0;
        var threads = Enumerable.Range(0, 4).Select(i => new Thread(() =>
        {
            using (var people = detector.Detect(new Frame(depth), camera))
                if (Everything(people).SequenceEqual(expected)) Interlocked.Increment(ref same);
        })).ToList();
        threads.ForEach(thread => thread.Start());
        threads.ForEach(thread => thread.Join());
        Expect(same == 4, "the same from four threads");
    }

    static void CheckOptions(string model)
    {
        using (var options = new Options())
        {
            options.Set("refine.min-score", "0.9");
            var option = options.List().Single(each => each.Name == "refine.min-score");
            Expect(option.Value == "0.9" && option.Low == 0 && option.High == 1 && option.Kind == OptionKind.Number && option.Help.EndsWith("."), "an option");
            ExpectError(Status.Argument, "did you mean", () => options.Set("refine.min-scores", "1"));
            ExpectError(Status.Input, "/n\u00f6ne.toml", () => options.Load("/n\u00f6ne.toml"));
            new Detector(model, options, 1, "cpu").Dispose();
        }
        ExpectError(Status.Argument, "abacus", () => new Detector(model, null, 0, "abacus"));
    }

    static void Main(string[] args)
    {
        var bytes = File.ReadAllBytes(args[1]);
        var depth = new ushort[bytes.Length / 2];
        Buffer.BlockCopy(bytes, 0, depth, 0, bytes.Length);
        var camera = new Camera(int.Parse(args[2]), int.Parse(args[3]), Number(args[4]), Number(args[5]), Number(args[6]), Number(args[7]));
        CheckOptions(args[0]);
        var detector = new Detector(args[0]);
        byte[] expected;
        using (var people = detector.Detect(new Frame(depth), camera))
        {
            CheckPeople(detector, people);
            expected = Everything(people);
        }
        CheckBodies(detector, depth, camera);
        CheckLayouts(detector, depth, camera, expected);
        CheckThreads(detector, depth, camera, expected);
        // Without Dispose the collector frees them, in any order.
        for (int i = 0; i < 3; ++i) new Tracker(detector).Update(new Frame(depth) { Time = i }, camera);
        GC.Collect();
        GC.WaitForPendingFinalizers();
        detector.Dispose();
        try
        {
            detector.Detect(new Frame(depth), camera);
            throw new Exception("expected a disposed detector to refuse");
        }
        catch (ObjectDisposedException) { }
        Console.WriteLine("vesalius {0} from C#", Detector.Version);
    }
}
