// Runs the scene of clients/unity/README.md as Unity would: enabled, a frame every few milliseconds, disabled at the end.

using System;
using System.Globalization;
using System.Reflection;
using DseUdp;
using UnityEngine;

static class Scene
{
    static int Main(string[] words)
    {
        CultureInfo.CurrentCulture = CultureInfo.InvariantCulture;
        if (words[0] == "frames") return Frames();
        if (words[0] == "movers") return Movers();
        Outside outside = new Outside { port = int.Parse(words[0], CultureInfo.InvariantCulture) };
        Send(outside, "OnEnable");
        if (Physics.autoSimulation) return 1;
        Console.WriteLine("a world at port " + outside.port);
        for (;;) Send(outside, "Update");
    }

    static void Send(MonoBehaviour to, string message)
    {
        typeof(DseWorld).GetMethod(message, BindingFlags.NonPublic | BindingFlags.Instance).Invoke(to, null);
    }

    static int Frames()
    {
        Vector3 place = DseFrame.Position(3.0, 4.0, 5.0);
        Console.WriteLine(place.x + " " + place.y + " " + place.z);
        for (int k = 0; k < 8; k++)
        {
            // One metre ahead of a car at the origin is where its transform looks.
            double heading = k * Math.PI / 4.0 - 3.0;
            Vector3 ahead = DseFrame.Position(Math.Cos(heading), Math.Sin(heading), 0.0);
            Vector3 forward = DseFrame.Rotation(heading).Forward;
            double apart = Math.Abs(ahead.x - forward.x) + Math.Abs(ahead.y - forward.y) + Math.Abs(ahead.z - forward.z);
            double turn = DseFrame.Heading(forward) - heading;
            Console.WriteLine(apart < 1e-5 && Math.Abs(Math.IEEERemainder(turn, 2.0 * Math.PI)) < 1e-5);
        }
        // Nose down: the front is below the origin.
        Console.WriteLine(DseFrame.Rotation(0.0, 0.1).Forward.y < 0f);
        return 0;
    }

    static int Movers()
    {
        DseMovers movers = new DseMovers();
        movers.prefabs[2] = new GameObject { name = "lorry" };
        Vector3 size = new Vector3(1.8f, 1.5f, 4.5f);
        for (int moment = 0; moment < 3; moment++)
        {
            movers.Show(1, moment, size, 10.0 + moment, 0.0, 1.0, 0.0);
            GameObject[] shown = (GameObject[])typeof(DseMovers).GetField("shown", BindingFlags.NonPublic | BindingFlags.Instance).GetValue(movers);
            GameObject one = shown[1];
            if (one == null) Console.WriteLine("none");
            else Console.WriteLine(one.name + " " + one.transform.position.x + " " + one.transform.position.y + " " + one.transform.localScale.z);
        }
        return 0;
    }
}
