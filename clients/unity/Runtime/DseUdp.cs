// The answering side of dse's datagrams (docs/udp.md) for Unity, Godot and .NET: C# 7.3, no dependencies, one file.
// README.md beside it shows a scene that answers.

using System;
using System.Collections.Generic;
using System.Net;
using System.Net.Sockets;
using System.Threading;

namespace DseUdp
{
    public enum Happened
    {
        /// <summary>A client began a session: put the world to its start, then answer with its state at Request.Time.</summary>
        Started,

        /// <summary>A step was asked for: advance from Request.Time by a step, then answer with the time reached.</summary>
        Step,

        /// <summary>The session is over; no answer.</summary>
        Ended,
    }

    /// <summary>What a client asked. Values is yours: nobody writes to it any more.</summary>
    public sealed class Request
    {
        public Happened Happened;
        public int Session, Sequence;
        public double Time;
        public bool IsLate;
        public double[] Values;
    }

    /// <summary>
    /// A world at a UDP port. A thread of its own receives, sends lost answers again and passes over what is none of
    /// ours; every method may be called from any thread.
    /// Lockstep: answer each Started and Step that TryTake gives, once.
    /// Free: TryTake gives Started and Ended only; read TryLatest and call Answer by your own clock (FixedUpdate).
    /// </summary>
    public sealed class World : IDisposable
    {
        public const int MagicVersion = 0x44534531;
        public const int MostValues = 8000;
        const int Start = 1, End = 2, Late = 4, Busy = 8, IsAnswer = 16;

        readonly object gate = new object();
        readonly Queue<Request> requests = new Queue<Request>();
        readonly Queue<int> over = new Queue<int>();
        readonly Socket line;
        readonly Thread receiver;
        readonly int asked;
        readonly bool isFree;
        readonly byte[] room, last;
        volatile bool isClosed;
        int session, sequence = -1, told = -1;
        EndPoint peer;
        Request latest;
        long ignored;

        /// <summary>Listen at a port, on loopback unless an address is given.</summary>
        /// <param name="asked">How many values come.</param>
        /// <param name="answered">How many values are answered.</param>
        public World(int port, int asked, int answered, bool isFree = false, IPAddress address = null)
        {
            if (asked < 0 || asked > MostValues || answered < 0 || answered > MostValues)
                throw new ArgumentOutOfRangeException("asked", "a packet has 0 to " + MostValues + " values");
            this.asked = asked;
            this.isFree = isFree;
            room = new byte[65536];
            last = new byte[28 + 8 * answered];
            IPAddress at = address ?? IPAddress.Loopback;
            line = new Socket(at.AddressFamily, SocketType.Dgram, ProtocolType.Udp);
            try
            {
                line.Bind(new IPEndPoint(at, port));
            }
            catch
            {
                line.Close();
                throw;
            }
            receiver = new Thread(Receive) { IsBackground = true, Name = "dse udp" };
            receiver.Start();
        }

        /// <summary>The port that is listened at.</summary>
        public int Port { get { return ((IPEndPoint)line.LocalEndPoint).Port; } }

        /// <summary>Whether a session is on.</summary>
        public bool IsOn { get { lock (gate) return session != 0; } }

        /// <summary>How many datagrams were passed over: torn, old, of other sessions, of a wrong size.</summary>
        public long Ignored { get { lock (gate) return ignored; } }

        /// <summary>The next thing that happened, waiting so many milliseconds (-1: for ever; 0: not at all).</summary>
        public bool TryTake(out Request request, int milliseconds = 0)
        {
            DateTime until = DateTime.UtcNow.AddMilliseconds(milliseconds);
            lock (gate)
            {
                while (requests.Count == 0 && !isClosed && milliseconds != 0)
                {
                    double left = (until - DateTime.UtcNow).TotalMilliseconds;
                    if (milliseconds > 0 && left <= 0) break;
                    if (milliseconds < 0) Monitor.Wait(gate); else Monitor.Wait(gate, (int)Math.Ceiling(left));
                }
                request = requests.Count > 0 ? requests.Dequeue() : null;
                return request != null;
            }
        }

        /// <summary>The newest that was heard in this session; false without one, and (free) before its start was taken.</summary>
        public bool TryLatest(out Request newest)
        {
            lock (gate)
            {
                newest = session != 0 && !(isFree && requests.Count > 0) ? latest : null;
                return newest != null;
            }
        }

        /// <summary>
        /// Tell the values at a time in s, as the answer to a request (lockstep) or after the newest one (free).
        /// An answer that comes twice, or too late for its request or session, is nothing.
        /// </summary>
        public void Answer(Request request, double time, double[] values)
        {
            if (values == null || values.Length != (last.Length - 28) / 8)
                throw new ArgumentException((last.Length - 28) / 8 + " values are answered", "values");
            lock (gate)
            {
                if (session == 0 || request.Session != session) return;
                if (!isFree && (request.Sequence != sequence || told == sequence)) return;
                told = isFree ? told + 1 : sequence;
                WriteHead(last, session, told, told == 0 ? Start : 0);
                WriteDouble(last, 16, time);
                for (int k = 0; k < values.Length; k++) WriteDouble(last, 24 + 8 * k, values[k]);
                Send(last, peer);
            }
        }

        /// <summary>End the session from this side: the run ends regularly, what it has is its result.</summary>
        public void EndSession()
        {
            lock (gate)
            {
                if (session == 0) return;
                WriteHead(last, session, Math.Max(sequence, 0), End);
                for (int k = 0; k < 3; k++) Send(last, peer); // any of them may be lost
                Forget();
            }
        }

        public void Dispose()
        {
            if (isClosed) return;
            isClosed = true;
            line.Close();
            lock (gate) Monitor.PulseAll(gate);
            if (Thread.CurrentThread != receiver) receiver.Join(1000);
        }

        void Receive()
        {
            EndPoint from = new IPEndPoint(line.AddressFamily == AddressFamily.InterNetworkV6 ? IPAddress.IPv6Any : IPAddress.Any, 0);
            while (!isClosed)
            {
                int size;
                EndPoint sender = from;
                try
                {
                    size = line.ReceiveFrom(room, ref sender);
                }
                catch (SocketException) // Windows tells here that an earlier answer found nobody
                {
                    if (!isClosed) Thread.Yield();
                    continue;
                }
                catch (ObjectDisposedException)
                {
                    return;
                }
                lock (gate)
                {
                    if (IsPacket(size)) Take(sender); else ignored++;
                }
            }
        }

        bool IsPacket(int size)
        {
            if (size != 28 + 8 * asked || ReadInt(0) != MagicVersion) return false;
            if (ReadInt(4) <= 0 || ReadInt(8) < 0 || ReadInt(8) != ReadInt(size - 4)) return false;
            if ((ReadInt(12) & ~(Start | End | Late)) != 0) return false;
            for (int at = 16; at < size - 4; at += 8)
            {
                double value = ReadDouble(at);
                if (double.IsNaN(value) || double.IsInfinity(value)) return false;
            }
            return true;
        }

        void Take(EndPoint sender)
        {
            int its = ReadInt(4), number = ReadInt(8), flags = ReadInt(12);
            bool starts = (flags & Start) != 0 && (flags & End) == 0 && number == 0 && !over.Contains(its);
            if (session == 0 && starts)
            {
                session = its;
                peer = sender;
                told = -1;
                requests.Clear();
                Hear(Happened.Started, number, flags);
            }
            else if (session != its && session != 0 && starts)
            {
                byte[] busy = new byte[last.Length];
                WriteHead(busy, its, number, Busy);
                Send(busy, sender);
            }
            else if (session != its || session == 0 || !sender.Equals(peer))
            {
                ignored++;
            }
            else if ((flags & End) != 0)
            {
                Forget();
                requests.Enqueue(new Request { Happened = Happened.Ended, Session = its, Sequence = number, Time = ReadDouble(16), Values = new double[0] });
                Monitor.PulseAll(gate);
            }
            else if (isFree ? (flags & Start) != 0 : number == sequence)
            {
                if (told >= 0) Send(last, peer); // its answer was lost
            }
            else if (isFree ? number > sequence : number == sequence + 1 && told == sequence)
            {
                Hear(Happened.Step, number, flags);
            }
            else
            {
                ignored++;
            }
        }

        void Hear(Happened what, int number, int flags)
        {
            Request heard = new Request { Happened = what, Session = session, Sequence = number, Time = ReadDouble(16), IsLate = (flags & Late) != 0 };
            heard.Values = new double[asked];
            for (int k = 0; k < asked; k++) heard.Values[k] = ReadDouble(24 + 8 * k);
            sequence = number;
            latest = heard;
            if (isFree && what == Happened.Step) return;
            requests.Enqueue(heard);
            Monitor.PulseAll(gate);
        }

        void Forget()
        {
            over.Enqueue(session);
            if (over.Count > 8) over.Dequeue();
            session = 0;
            sequence = told = -1;
            latest = null;
            requests.Clear();
        }

        void Send(byte[] data, EndPoint to)
        {
            try
            {
                line.SendTo(data, to);
            }
            catch (SocketException)
            {
                // as if it were lost: it is asked for again
            }
            catch (ObjectDisposedException)
            {
            }
        }

        // Bytes one by one: the same on every machine, and nothing for the garbage collector.

        int ReadInt(int at)
        {
            return room[at] | room[at + 1] << 8 | room[at + 2] << 16 | room[at + 3] << 24;
        }

        double ReadDouble(int at)
        {
            return BitConverter.Int64BitsToDouble((long)(uint)ReadInt(at) | (long)ReadInt(at + 4) << 32);
        }

        static void WriteInt(byte[] data, int at, int value)
        {
            for (int k = 0; k < 4; k++) data[at + k] = (byte)(value >> 8 * k);
        }

        static void WriteDouble(byte[] data, int at, double value)
        {
            long bits = BitConverter.DoubleToInt64Bits(value);
            for (int k = 0; k < 8; k++) data[at + k] = (byte)(bits >> 8 * k);
        }

        static void WriteHead(byte[] data, int session, int sequence, int flags)
        {
            WriteInt(data, 0, MagicVersion);
            WriteInt(data, 4, session);
            WriteInt(data, 8, sequence);
            WriteInt(data, 12, flags | IsAnswer);
            WriteInt(data, data.Length - 4, sequence);
        }
    }
}
