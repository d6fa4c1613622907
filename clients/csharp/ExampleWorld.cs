// A point mass on a road, 20 m behind a wall it drives towards: asked for a force, it tells place, speed and gap.
// Mono: mcs -out:ExampleWorld.exe ../unity/Runtime/DseUdp.cs ExampleWorld.cs && mono ExampleWorld.exe 5005
// dse udp check 127.0.0.1:5005 --out 1 --back 3 --step 0.01

using System;
using System.Globalization;
using System.Threading;
using DseUdp;

static class ExampleWorld
{
    const double Mass = 1200.0, Step = 0.01;
    static double place, speed;

    static void Advance(double force)
    {
        place += 0.5 * Step * speed;
        speed += Step * force / Mass;
        place += 0.5 * Step * speed;
    }

    static double[] State()
    {
        return new[] { place, speed, 20.0 - place };
    }

    static int Main(string[] words)
    {
        int port = words.Length > 0 ? int.Parse(words[0], CultureInfo.InvariantCulture) : 5005;
        bool isFree = words.Length > 1 && words[1] == "free";
        using (World world = new World(port, 1, 3, isFree))
        {
            Console.WriteLine("a world at 127.0.0.1:" + world.Port);
            if (isFree) Free(world); else Lockstep(world);
        }
        return 0;
    }

    static void Lockstep(World world)
    {
        Request request;
        while (world.TryTake(out request, -1))
        {
            if (request.Happened == Happened.Ended) continue;
            if (request.Happened == Happened.Started) place = speed = 0.0;
            else Advance(request.Values[0]);
            world.Answer(request, request.Time + (request.Happened == Happened.Step ? Step : 0.0), State());
        }
    }

    // By its own clock, as Unity's FixedUpdate: the newest force counts, nobody waits for anybody.
    static void Free(World world)
    {
        double time = 0.0, deadline = 0.0;
        var clock = System.Diagnostics.Stopwatch.StartNew();
        for (;;)
        {
            // Deadlines are absolute, so that delays do not add up; more than 0.1 s is not caught up.
            deadline += Step;
            double rest = deadline - clock.Elapsed.TotalSeconds;
            if (rest < -0.1) deadline -= rest;
            if (rest > 0.0) Thread.Sleep((int)(1000 * rest));
            Request request;
            while (world.TryTake(out request))
            {
                if (request.Happened != Happened.Started) continue;
                place = speed = 0.0;
                time = request.Time;
                world.Answer(request, time, State());
            }
            if (!world.TryLatest(out request)) continue;
            Advance(request.Values[0]);
            time += Step;
            world.Answer(request, time, State());
        }
    }
}
