// vesalius for C#: the C interface (vesalius.h) as classes. One file to copy into a project; no unsafe code, C# 6, .NET
// Framework 4, .NET Standard 2.0, Mono and Unity. The comments of vesalius.h hold here as well: units, threads, errors.

using System;
using System.Collections.Generic;
using System.Runtime.InteropServices;
using System.Text;

namespace Vesalius
{
    /// <summary>What the library refuses: its status and one line.</summary>
    public class VesaliusException : Exception
    {
        public Status Status { get; private set; }
        internal VesaliusException(Status status, string message) : base(message) { Status = status; }
    }

    public enum Status { Ok = 0, Argument = 1, Capacity = 2, Input = 3, Device = 4, Memory = 5, Internal = 6 }
    public enum OptionKind { Number = 0, WholeNumber = 1, Truth = 2, Word = 3 }
    public enum Lens { Pinhole = 0, BrownConrady = 1, ModifiedBrownConrady = 2, KannalaBrandt = 3 }
    public enum ColourFormat { Rgb = 0, Bgr = 1, Rgba = 2, Bgra = 3 }
    public enum PersonState { Seen = 0, New = 1, Tracked = 2, Hidden = 3, Lost = 4 }
    public enum Stance { Unknown = 0, Standing = 1, Sitting = 2, Lying = 3, Fallen = 4 }
    public enum JointState { None = 0, Predicted = 1, Observed = 2 }
    public enum UnseenReason { None = 0, OutOfPicture = 1, BehindPerson = 2, BehindSomething = 3, NoDepth = 4, NotSure = 5 }

    /// <summary>A joint: metres, x right, y down, z away from the camera; NaN where nothing is known of it.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public struct Joint
    {
        public float X, Y, Z;
        public float Confidence;
        public JointState State;
    }

    /// <summary>A part of the body: the centre of what is visible of it, metres, and standard deviations along its own
    /// axes.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public struct Part
    {
        public float X, Y, Z;
        public float Extent0, Extent1, Extent2;
        public float Confidence;
        public JointState State;
    }

    /// <summary>Why a joint or part is not observed; where a person hides it the index of that person, its own behind the
    /// own body, otherwise -1.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public struct Unseen
    {
        public UnseenReason Why;
        public int Behind;
    }

    /// <summary>A bone of a fitted body: its ends, metres, and the unit quaternion from the bone's frame to the camera's.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public struct Bone
    {
        public float HeadX, HeadY, HeadZ;
        public float TailX, TailY, TailZ;
        public float RotationX, RotationY, RotationZ, RotationW;
        public float Length;
        public float Confidence;
        public JointState State;
    }

    /// <summary>A unit quaternion, from the joint's frame to the camera's; NaN where it is unknown.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public struct Rotation
    {
        public float X, Y, Z, W;
    }

    /// <summary>The camera of the depth picture, pixels.</summary>
    public class Camera
    {
        public int Width, Height;
        public float Fx, Fy, Cx, Cy;
        public Lens Lens = Lens.Pinhole;
        /// <summary>Coefficients of the lens, at most 8.</summary>
        public double[] Distortion = new double[0];

        public Camera(int width, int height, float fx, float fy, float cx, float cy)
        {
            Width = width; Height = height; Fx = fx; Fy = fy; Cx = cx; Cy = cy;
        }

        internal Native.Camera ToNative()
        {
            if (Distortion.Length > 8) throw new ArgumentException("Distortion: expected at most 8 coefficients");
            var distortion = new double[8];
            Distortion.CopyTo(distortion, 0);
            return new Native.Camera
            {
                StructSize = (uint)Marshal.SizeOf(typeof(Native.Camera)), Lens = (int)Lens, Width = Width, Height = Height,
                Fx = Fx, Fy = Fy, Cx = Cx, Cy = Cy, Distortion = distortion
            };
        }
    }

    /// <summary>One picture of the size of its camera: depth in millimetres or in metres, row by row from the top.</summary>
    public class Frame
    {
        /// <summary>Millimetres, 0 = no reading; or null, where there are metres.</summary>
        public ushort[] DepthMillimetres;
        /// <summary>Metres; what is no distance is no reading.</summary>
        public float[] DepthMetres;
        /// <summary>8 bits a channel, registered to depth; null without colour.</summary>
        public byte[] Colour;
        public ColourFormat ColourFormat = ColourFormat.Rgb;
        /// <summary>Rows are stored bottom up, as Unity's textures are.</summary>
        public bool BottomUp;
        /// <summary>Seconds since any moment; null without times.</summary>
        public double? Time;

        public Frame(ushort[] depthMillimetres) { DepthMillimetres = depthMillimetres; }
        public Frame(float[] depthMetres) { DepthMetres = depthMetres; }

        /// <summary>Calls the library with pinned arrays.</summary>
        internal People Find(Camera camera, Func<Native.Frame, Native.Camera, IntPtr> call)
        {
            var depth = (Array)DepthMillimetres ?? DepthMetres;
            int depthBytes = DepthMillimetres != null ? 2 : 4;
            int colourBytes = ColourFormat == ColourFormat.Rgb || ColourFormat == ColourFormat.Bgr ? 3 : 4;
            Expect("depth", depth, (long)camera.Width * camera.Height);
            if (Colour != null) Expect("colour", Colour, (long)camera.Width * camera.Height * colourBytes);
            var native = new Native.Frame
            {
                StructSize = (uint)Marshal.SizeOf(typeof(Native.Frame)), DepthFormat = DepthMillimetres != null ? 0 : 1,
                ColourFormat = (int)ColourFormat, HasTime = Time.HasValue ? 1 : 0, Time = Time ?? 0
            };
            var depthPin = GCHandle.Alloc(depth, GCHandleType.Pinned);
            var colourPin = GCHandle.Alloc(Colour, GCHandleType.Pinned);
            try
            {
                native.Depth = First(depthPin.AddrOfPinnedObject(), camera, depthBytes, out native.DepthStride);
                if (Colour != null)
                    native.Colour = First(colourPin.AddrOfPinnedObject(), camera, colourBytes, out native.ColourStride);
                return new People(call(native, camera.ToNative()), camera.Width, camera.Height);
            }
            finally
            {
                depthPin.Free();
                colourPin.Free();
            }
        }

        static void Expect(string name, Array values, long length)
        {
            if (values == null) throw new ArgumentNullException(name);
            if (values.LongLength != length)
                throw new ArgumentException(name + ": " + values.LongLength + " values, expected " + length);
        }

        IntPtr First(IntPtr start, Camera camera, int bytes, out long stride)
        {
            stride = 0;
            if (!BottomUp) return start;
            long row = (long)camera.Width * bytes;
            stride = -row;
            return new IntPtr(start.ToInt64() + row * (camera.Height - 1));
        }
    }

    /// <summary>An option with its value; both as text.</summary>
    public class Option
    {
        public string Name, Value, Unit, Help;
        public OptionKind Kind;
        public double Low, High;
    }

    /// <summary>The options that `vesalius options` lists, under the same names.</summary>
    public sealed class Options : IDisposable
    {
        internal readonly Native.OptionsHandle Handle;

        public Options()
        {
            IntPtr made;
            Native.Check(Native.vesalius_options_create(out made));
            Handle = new Native.OptionsHandle(made);
        }

        public void Set(string name, string value) { Native.Check(Native.vesalius_options_set(Handle, Native.Utf8(name), Native.Utf8(value))); }
        public void Load(string path) { Native.Check(Native.vesalius_options_load(Handle, Native.Utf8(path))); }

        public IList<Option> List()
        {
            var all = new List<Option>();
            int count = Native.vesalius_options_count(Handle);
            for (int i = 0; i < count; ++i)
            {
                var native = new Native.Option { StructSize = (uint)Marshal.SizeOf(typeof(Native.Option)) };
                Native.Check(Native.vesalius_options_get(Handle, i, ref native));
                all.Add(new Option
                {
                    Name = Native.Text(native.Name), Value = Native.Text(native.Value), Unit = Native.Text(native.Unit),
                    Help = Native.Text(native.Help), Kind = (OptionKind)native.Kind, Low = native.Low, High = native.High
                });
            }
            return all;
        }

        public void Dispose() { Handle.Dispose(); }
    }

    /// <summary>Finds the people in one frame at a time. It may be used from several threads.</summary>
    public sealed class Detector : IDisposable
    {
        /// <summary>The version of the binary interface that this file is written for.</summary>
        public const int AbiVersion = 0;

        internal readonly Native.DetectorHandle Handle;
        string[] parts;
        readonly Dictionary<string, string[]> joints = new Dictionary<string, string[]>();

        public static string Version { get { return Native.Text(Native.vesalius_version()); } }

        /// <param name="model">A .forest file; null: the one that comes with vesalius.</param>
        /// <param name="options">Null: the defaults.</param>
        /// <param name="threads">Most threads; 0 for all.</param>
        /// <param name="device">cpu, cuda, cuda:N or auto; null: cpu.</param>
        public Detector(string model = null, Options options = null, int threads = 0, string device = null)
        {
            if (Native.vesalius_abi_version() != AbiVersion)
                throw new VesaliusException(Status.Internal, "libvesalius has interface " + Native.vesalius_abi_version() + ", expected " + AbiVersion);
            IntPtr made;
            var handle = options != null ? options.Handle : new Native.OptionsHandle(IntPtr.Zero);
            Native.Check(Native.vesalius_detector_create(Native.Utf8(model), handle, threads, Native.Utf8(device), out made));
            Handle = new Native.DetectorHandle(made);
        }

        /// <summary>The people, the most certain first.</summary>
        public People Detect(Frame frame, Camera camera)
        {
            return frame.Find(camera, (f, c) =>
            {
                IntPtr people;
                Native.Check(Native.vesalius_detector_detect(Handle, ref f, ref c, out people));
                return people;
            });
        }

        /// <summary>Names of the parts, by their numbers in Person.Labels.</summary>
        public string[] Parts
        {
            get
            {
                return parts ?? (parts = Native.Names(Native.vesalius_detector_part_count(Handle),
                                                      i => Native.vesalius_detector_part_name(Handle, i)));
            }
        }

        public string[] JointSets
        {
            get
            {
                return Native.Names(Native.vesalius_detector_joint_set_count(Handle),
                                    i => Native.vesalius_detector_joint_set_name(Handle, i));
            }
        }

        /// <summary>Names of a set's joints, in their order.</summary>
        public string[] JointNames(string set = "k4abt32")
        {
            lock (joints)
            {
                string[] names;
                if (joints.TryGetValue(set, out names)) return names;
                var name = Native.Utf8(set);
                names = Native.Names(Native.vesalius_detector_joint_count(Handle, name),
                                     i => Native.vesalius_detector_joint_name(Handle, name, i));
                return joints[set] = names;
            }
        }

        /// <summary>Names of the bones of the bodies that a tracker fits.</summary>
        public string[] Bones
        {
            get
            {
                return Native.Names(Native.vesalius_detector_bone_count(Handle),
                                    i => Native.vesalius_detector_bone_name(Handle, i));
            }
        }

        /// <summary>For each bone the one whose child it is, which comes before it; -1 for the first.</summary>
        public int[] BoneParents
        {
            get
            {
                var parents = new int[Native.vesalius_detector_bone_count(Handle)];
                for (int i = 0; i < parents.Length; ++i) parents[i] = Native.vesalius_detector_bone_parent(Handle, i);
                return parents;
            }
        }

        public void Dispose() { Handle.Dispose(); }
    }

    /// <summary>Follows people over the frames of one source: ids that hold, fitted bodies.</summary>
    public sealed class Tracker : IDisposable
    {
        readonly Native.TrackerHandle handle;

        public Tracker(Detector detector)
        {
            IntPtr made;
            Native.Check(Native.vesalius_tracker_create(detector.Handle, out made));
            handle = new Native.TrackerHandle(made);
        }

        /// <summary>Takes the next frame. The people by their ids; hidden ones are among them.</summary>
        public People Update(Frame frame, Camera camera)
        {
            return frame.Find(camera, (f, c) =>
            {
                IntPtr people;
                Native.Check(Native.vesalius_tracker_update(handle, ref f, ref c, out people));
                return people;
            });
        }

        public void Dispose() { handle.Dispose(); }
    }

    /// <summary>The people of one frame. Dispose it when its people are not needed any more.</summary>
    public sealed class People : IDisposable
    {
        internal readonly Native.PeopleHandle Handle;
        public readonly int Width, Height;
        public readonly int Count;

        internal People(IntPtr made, int width, int height)
        {
            Handle = new Native.PeopleHandle(made);
            Width = width;
            Height = height;
            Count = Native.vesalius_people_count(Handle);
        }

        public Person this[int index] { get { return new Person(this, index); } }
        public void Dispose() { Handle.Dispose(); }
    }

    /// <summary>Somebody in a frame.</summary>
    public sealed class Person
    {
        readonly People people;
        readonly int index;
        /// <summary>From 1, the same over the frames of a tracker; 0 from a detector.</summary>
        public readonly int Id;
        public readonly PersonState State;
        /// <summary>How certain it is, 0 to 1.</summary>
        public readonly float Score;
        /// <summary>Smallest box around the mask, pixels.</summary>
        public readonly int BoxU, BoxV, BoxWidth, BoxHeight;
        /// <summary>Which way the person faces, radians: 0 the camera, positive turned to the own left; NaN if unknown.</summary>
        public readonly float Yaw;
        /// <summary>Of the trunk, metres a second; NaN from a detector.</summary>
        public readonly float VelocityX, VelocityY, VelocityZ;
        public readonly Stance Stance;
        /// <summary>Height standing upright, metres, by the fitted body; NaN without one.</summary>
        public readonly float Stature;

        internal Person(People people, int index)
        {
            this.people = people;
            this.index = index;
            var native = new Native.Person { StructSize = (uint)Marshal.SizeOf(typeof(Native.Person)) };
            Native.Check(Native.vesalius_people_get(people.Handle, index, ref native));
            Id = native.Id;
            State = (PersonState)native.State;
            Score = native.Score;
            BoxU = native.BoxU; BoxV = native.BoxV; BoxWidth = native.BoxWidth; BoxHeight = native.BoxHeight;
            Yaw = native.Yaw;
            VelocityX = native.VelocityX; VelocityY = native.VelocityY; VelocityZ = native.VelocityZ;
            Stance = (Stance)native.Stance;
            Stature = native.Stature;
        }

        public Joint[] Joints(string set = "k4abt32")
        {
            var name = Native.Utf8(set);
            return Native.Copy((Joint[] to, int capacity, out int count) => Native.vesalius_people_joints(people.Handle, index, name, to, capacity, out count));
        }

        public Part[] Parts()
        {
            return Native.Copy((Part[] to, int capacity, out int count) => Native.vesalius_people_parts(people.Handle, index, to, capacity, out count));
        }

        /// <summary>The bones of the fitted body, by Detector.Bones; none without one.</summary>
        public Bone[] Bones()
        {
            return Native.Copy((Bone[] to, int capacity, out int count) => Native.vesalius_people_bones(people.Handle, index, to, capacity, out count));
        }

        /// <summary>Why joints of a set are not observed, in the order of Joints.</summary>
        public Unseen[] JointsUnseen(string set = "k4abt32")
        {
            var name = Native.Utf8(set);
            return Native.Copy((Unseen[] to, int capacity, out int count) => Native.vesalius_people_joints_unseen(people.Handle, index, name, to, capacity, out count));
        }

        /// <summary>Why parts are not observed, in the order of Parts.</summary>
        public Unseen[] PartsUnseen()
        {
            return Native.Copy((Unseen[] to, int capacity, out int count) => Native.vesalius_people_parts_unseen(people.Handle, index, to, capacity, out count));
        }

        /// <summary>Rotations of a set's joints, by the fitted body; the set k4abt32 has some.</summary>
        public Rotation[] Rotations(string set = "k4abt32")
        {
            var name = Native.Utf8(set);
            return Native.Copy((Rotation[] to, int capacity, out int count) => Native.vesalius_people_rotations(people.Handle, index, name, to, capacity, out count));
        }

        /// <summary>Row by row from the top: 1 on the person's pixels, 0 elsewhere.</summary>
        public byte[] Mask()
        {
            int count;
            var mask = new byte[people.Width * people.Height];
            Native.Check(Native.vesalius_people_mask(people.Handle, index, mask, mask.Length, out count));
            return mask;
        }

        /// <summary>Row by row from the top: the part that each of the person's pixels shows, 255 elsewhere.</summary>
        public byte[] Labels()
        {
            int count;
            var labels = new byte[people.Width * people.Height];
            Native.Check(Native.vesalius_people_labels(people.Handle, index, labels, labels.Length, out count));
            return labels;
        }
    }

    /// <summary>vesalius.h as it stands.</summary>
    internal static class Native
    {
        /// <summary>libvesalius.so on the library path or beside the program.</summary>
        const string Library = "vesalius";

        [StructLayout(LayoutKind.Sequential)]
        internal struct Option
        {
            public uint StructSize;
            public int Kind;
            public IntPtr Name, Value, Unit, Help;
            public double Low, High;
        }

        [StructLayout(LayoutKind.Sequential)]
        internal struct Camera
        {
            public uint StructSize;
            public int Lens;
            public int Width, Height;
            public float Fx, Fy, Cx, Cy;
            [MarshalAs(UnmanagedType.ByValArray, SizeConst = 8)]
            public double[] Distortion;
        }

        [StructLayout(LayoutKind.Sequential)]
        internal struct Frame
        {
            public uint StructSize;
            public int DepthFormat;
            public IntPtr Depth;
            public long DepthStride;
            public IntPtr Colour;
            public long ColourStride;
            public int ColourFormat;
            public int HasTime;
            public double Time;
            public float UpX, UpY, UpZ;
            public int HasUp;
        }

        [StructLayout(LayoutKind.Sequential)]
        internal struct Person
        {
            public uint StructSize;
            public int Id, State;
            public float Score;
            public int BoxU, BoxV, BoxWidth, BoxHeight;
            public float Yaw;
            public float VelocityX, VelocityY, VelocityZ;
            public int Stance;
            public float Stature;
        }

        internal abstract class Handle : SafeHandle
        {
            protected Handle(IntPtr made) : base(IntPtr.Zero, true) { SetHandle(made); }
            public override bool IsInvalid { get { return handle == IntPtr.Zero; } }
        }
        internal sealed class OptionsHandle : Handle
        {
            internal OptionsHandle(IntPtr made) : base(made) { }
            protected override bool ReleaseHandle() { vesalius_options_destroy(handle); return true; }
        }
        internal sealed class DetectorHandle : Handle
        {
            internal DetectorHandle(IntPtr made) : base(made) { }
            protected override bool ReleaseHandle() { vesalius_detector_destroy(handle); return true; }
        }
        internal sealed class TrackerHandle : Handle
        {
            internal TrackerHandle(IntPtr made) : base(made) { }
            protected override bool ReleaseHandle() { vesalius_tracker_destroy(handle); return true; }
        }
        internal sealed class PeopleHandle : Handle
        {
            internal PeopleHandle(IntPtr made) : base(made) { }
            protected override bool ReleaseHandle() { vesalius_people_destroy(handle); return true; }
        }

        internal static void Check(Status status)
        {
            if (status != Status.Ok) throw new VesaliusException(status, Text(vesalius_last_error()));
        }

        internal static byte[] Utf8(string text)
        {
            return text == null ? null : Encoding.UTF8.GetBytes(text + "\0");
        }

        internal static string Text(IntPtr utf8)
        {
            if (utf8 == IntPtr.Zero) return null;
            int length = 0;
            while (Marshal.ReadByte(utf8, length) != 0) ++length;
            var bytes = new byte[length];
            Marshal.Copy(utf8, bytes, 0, length);
            return Encoding.UTF8.GetString(bytes);
        }

        internal static string[] Names(int count, Func<int, IntPtr> name)
        {
            if (count < 0) Check(Status.Argument);
            var names = new string[count];
            for (int i = 0; i < count; ++i) names[i] = Text(name(i));
            return names;
        }

        /// <summary>A function of the library that copies an array, and tells its length where there is no room.</summary>
        internal delegate Status Give<T>(T[] to, int capacity, out int count);

        internal static T[] Copy<T>(Give<T> give)
        {
            int count;
            Check(give(null, 0, out count));
            var all = new T[count];
            Check(give(all, count, out count));
            return all;
        }

        [DllImport(Library)] internal static extern IntPtr vesalius_version();
        [DllImport(Library)] internal static extern int vesalius_abi_version();
        [DllImport(Library)] internal static extern IntPtr vesalius_last_error();
        [DllImport(Library)] internal static extern Status vesalius_options_create(out IntPtr options);
        [DllImport(Library)] internal static extern Status vesalius_options_set(OptionsHandle options, byte[] name, byte[] value);
        [DllImport(Library)] internal static extern Status vesalius_options_load(OptionsHandle options, byte[] path);
        [DllImport(Library)] internal static extern int vesalius_options_count(OptionsHandle options);
        [DllImport(Library)] internal static extern Status vesalius_options_get(OptionsHandle options, int index, ref Option option);
        [DllImport(Library)] internal static extern void vesalius_options_destroy(IntPtr options);
        [DllImport(Library)] internal static extern Status vesalius_detector_create(byte[] model, OptionsHandle options, int threads, byte[] device, out IntPtr detector);
        [DllImport(Library)] internal static extern Status vesalius_detector_detect(DetectorHandle detector, ref Frame frame, ref Camera camera, out IntPtr people);
        [DllImport(Library)] internal static extern void vesalius_detector_destroy(IntPtr detector);
        [DllImport(Library)] internal static extern int vesalius_detector_part_count(DetectorHandle detector);
        [DllImport(Library)] internal static extern IntPtr vesalius_detector_part_name(DetectorHandle detector, int part);
        [DllImport(Library)] internal static extern int vesalius_detector_joint_set_count(DetectorHandle detector);
        [DllImport(Library)] internal static extern IntPtr vesalius_detector_joint_set_name(DetectorHandle detector, int set);
        [DllImport(Library)] internal static extern int vesalius_detector_joint_count(DetectorHandle detector, byte[] set);
        [DllImport(Library)] internal static extern IntPtr vesalius_detector_joint_name(DetectorHandle detector, byte[] set, int joint);
        [DllImport(Library)] internal static extern int vesalius_detector_bone_count(DetectorHandle detector);
        [DllImport(Library)] internal static extern IntPtr vesalius_detector_bone_name(DetectorHandle detector, int bone);
        [DllImport(Library)] internal static extern int vesalius_detector_bone_parent(DetectorHandle detector, int bone);
        [DllImport(Library)] internal static extern Status vesalius_tracker_create(DetectorHandle detector, out IntPtr tracker);
        [DllImport(Library)] internal static extern Status vesalius_tracker_update(TrackerHandle tracker, ref Frame frame, ref Camera camera, out IntPtr people);
        [DllImport(Library)] internal static extern void vesalius_tracker_destroy(IntPtr tracker);
        [DllImport(Library)] internal static extern int vesalius_people_count(PeopleHandle people);
        [DllImport(Library)] internal static extern Status vesalius_people_get(PeopleHandle people, int index, ref Person person);
        [DllImport(Library)] internal static extern Status vesalius_people_joints(PeopleHandle people, int index, byte[] set, [Out] Joint[] joints, int capacity, out int count);
        [DllImport(Library)] internal static extern Status vesalius_people_parts(PeopleHandle people, int index, [Out] Part[] parts, int capacity, out int count);
        [DllImport(Library)] internal static extern Status vesalius_people_joints_unseen(PeopleHandle people, int index, byte[] set, [Out] Unseen[] unseen, int capacity, out int count);
        [DllImport(Library)] internal static extern Status vesalius_people_parts_unseen(PeopleHandle people, int index, [Out] Unseen[] unseen, int capacity, out int count);
        [DllImport(Library)] internal static extern Status vesalius_people_bones(PeopleHandle people, int index, [Out] Bone[] bones, int capacity, out int count);
        [DllImport(Library)] internal static extern Status vesalius_people_rotations(PeopleHandle people, int index, byte[] set, [Out] Rotation[] rotations, int capacity, out int count);
        [DllImport(Library)] internal static extern Status vesalius_people_mask(PeopleHandle people, int index, [Out] byte[] mask, int capacity, out int count);
        [DllImport(Library)] internal static extern Status vesalius_people_labels(PeopleHandle people, int index, [Out] byte[] labels, int capacity, out int count);
        [DllImport(Library)] internal static extern void vesalius_people_destroy(IntPtr people);
    }
}
