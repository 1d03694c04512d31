// A component for Unity that follows people in depth pictures and shows their joints as spheres. docs/c.md says where the
// files go. Whoever has a depth camera calls Submit with each of its pictures.

using System;
using System.Collections.Generic;
using System.IO;
using System.Threading.Tasks;
using UnityEngine;

public class VesaliusPeople : MonoBehaviour
{
    [SerializeField] string model = "default.model";  // in StreamingAssets
    [SerializeField] string jointSet = "k4abt32";
    [SerializeField] int threads = 2;
    [SerializeField] float sphereSize = 0.06f;  // metres

    Vesalius.Detector detector;
    Vesalius.Tracker tracker;
    Task<List<Sighting>> work;
    readonly Dictionary<int, GameObject[]> spheres = new Dictionary<int, GameObject[]>();

    /// <summary>Somebody in the last picture that was worked at.</summary>
    public struct Sighting
    {
        public int Id;
        public Vesalius.PersonState State;
        public Vesalius.Joint[] Joints;
    }

    /// <summary>The people of the last picture that was worked at, by their ids.</summary>
    public IList<Sighting> People { get; private set; }

    void Awake()
    {
        People = new List<Sighting>();
        detector = new Vesalius.Detector(Path.Combine(Application.streamingAssetsPath, model), null, threads);
        tracker = new Vesalius.Tracker(detector);
    }

    /// <summary>Takes a picture of depth, millimetres, row by row from the top, with its time in seconds. Returns false, and
    /// leaves the picture out, while the one before is still worked at. The array must not change meanwhile.</summary>
    public bool Submit(ushort[] depth, Vesalius.Camera camera, double time)
    {
        if (work != null) return false;
        var frame = new Vesalius.Frame(depth) { Time = time };
        work = Task.Run(() => Follow(frame, camera));
        return true;
    }

    // Runs beside the game, which goes on drawing.
    List<Sighting> Follow(Vesalius.Frame frame, Vesalius.Camera camera)
    {
        var found = new List<Sighting>();
        using (var people = tracker.Update(frame, camera))
        {
            for (int i = 0; i < people.Count; ++i)
            {
                var person = people[i];
                if (person.State == Vesalius.PersonState.Lost) continue;
                found.Add(new Sighting { Id = person.Id, State = person.State, Joints = person.Joints(jointSet) });
            }
        }
        return found;
    }

    void Update()
    {
        if (work == null || !work.IsCompleted) return;
        var done = work;
        work = null;
        if (done.IsFaulted)
        {
            Debug.LogError(done.Exception.GetBaseException().Message);
            return;
        }
        People = done.Result;
        Show();
    }

    void Show()
    {
        var gone = new List<int>(spheres.Keys);
        foreach (var person in People)
        {
            gone.Remove(person.Id);
            GameObject[] shown;
            if (!spheres.TryGetValue(person.Id, out shown)) spheres[person.Id] = shown = MakeSpheres(person.Joints.Length);
            for (int j = 0; j < shown.Length; ++j)
            {
                var joint = person.Joints[j];
                shown[j].SetActive(joint.State != Vesalius.JointState.None);
                // Unity has y up; x right and z away from the camera are the same.
                if (joint.State != Vesalius.JointState.None) shown[j].transform.localPosition = new Vector3(joint.X, -joint.Y, joint.Z);
            }
        }
        foreach (int id in gone)
        {
            foreach (var sphere in spheres[id]) Destroy(sphere);
            spheres.Remove(id);
        }
    }

    GameObject[] MakeSpheres(int count)
    {
        var made = new GameObject[count];
        for (int j = 0; j < count; ++j)
        {
            made[j] = GameObject.CreatePrimitive(PrimitiveType.Sphere);
            made[j].transform.SetParent(transform, false);
            made[j].transform.localScale = new Vector3(sphereSize, sphereSize, sphereSize);
        }
        return made;
    }

    void OnDestroy()
    {
        // What is at work ends first: it uses the tracker.
        if (work != null) try { work.Wait(); } catch (AggregateException) { }
        if (tracker != null) tracker.Dispose();
        if (detector != null) detector.Dispose();
    }
}
