// A scene that answers a co-simulation of dse: derive from DseWorld, and add the class to one object of the scene.

using UnityEngine;

namespace DseUdp
{
    /// <summary>
    /// Makes the requested steps one after another, whatever the frame rate. Physics is advanced by these steps only.
    /// The counts of values are those of `dse udp layout COMPONENT`.
    /// </summary>
    public abstract class DseWorld : MonoBehaviour
    {
        /// <summary>Listens on loopback at this port.</summary>
        public int port = 5005;

        /// <summary>Communication step of the bench in s.</summary>
        public double step = 0.01;

        /// <summary>Milliseconds that a frame waits for requests, so that the picture keeps moving.</summary>
        public int patience = 10;

        World world;
        double[] state;

        /// <summary>How many values come.</summary>
        protected abstract int Asked { get; }

        /// <summary>How many values are answered.</summary>
        protected abstract int Answered { get; }

        /// <summary>Put the scene to its start.</summary>
        protected abstract void Begin();

        /// <summary>Advance by a step in s, with the values that came.</summary>
        protected abstract void Advance(double[] asked, double seconds);

        /// <summary>Write the state of the scene into the values of the answer.</summary>
        protected abstract void Read(double[] answered);

        /// <summary>The session has ended; the scene stays as it is.</summary>
        protected virtual void Finish()
        {
        }

        void OnEnable()
        {
            Physics.autoSimulation = false;
            state = new double[Answered];
            world = new World(port, Asked, Answered);
        }

        void OnDisable()
        {
            world.Dispose();
            world = null;
        }

        void Update()
        {
            Request request;
            while (world.TryTake(out request, patience))
            {
                if (request.Happened == Happened.Ended)
                {
                    Finish();
                    return;
                }
                double reached = request.Time;
                if (request.Happened == Happened.Started)
                {
                    Begin();
                }
                else
                {
                    Advance(request.Values, step);
                    reached += step;
                }
                Read(state);
                world.Answer(request, reached, state);
            }
        }
    }
}
