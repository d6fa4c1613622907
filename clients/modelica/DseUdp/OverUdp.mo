within DseUdp;
model OverUdp "Car with the datagrams of docs/udp.md by Modelica_DeviceDrivers 2, for Dymola and OpenModelica"
  import Modelica_DeviceDrivers.Blocks.Packaging.SerialPackager;
  import Modelica_DeviceDrivers.Blocks.Communication;
  constant Integer magic = 1146307889 "0x44534531";
  parameter Integer session(min = 1) = 1 "another one for each run";
  parameter String worldHost = "127.0.0.1";
  parameter Integer worldPort = 5005;
  parameter Integer ownPort = 5006 "answers must be sent to it: 'dse world --answers 127.0.0.1:5006'";
  parameter Real step(unit = "s") = 0.01;
  Car car;
  Integer sequence(start = -1, fixed = true);
  Boolean isGood "what came is a whole packet of this session";
  discrete Real told[4](each start = 0, each fixed = true) "time, place, speed, gap of the newest answer";
  Integer newest(start = -1, fixed = true);
  Integer ignored(start = 0, fixed = true) "samples without a packet that can be used";

  SerialPackager.Packager packager;
  SerialPackager.AddInteger head(n = 4, nu = 1);
  SerialPackager.AddReal values(n = 2, nu = 1);
  SerialPackager.AddInteger closing(n = 1, nu = 1);
  Communication.UDPSend send(IPAddress = worldHost, port_send = worldPort, sampleTime = step);

  Communication.UDPReceive receive(port_recv = ownPort, sampleTime = step);
  SerialPackager.GetInteger headBack(n = 4, nu = 1);
  SerialPackager.GetReal valuesBack(n = 4, nu = 1);
  SerialPackager.GetInteger closingBack(n = 1);
equation
  connect(packager.pkgOut, head.pkgIn);
  connect(head.pkgOut[1], values.pkgIn);
  connect(values.pkgOut[1], closing.pkgIn);
  connect(closing.pkgOut[1], send.pkgIn);
  connect(receive.pkgOut, headBack.pkgIn);
  connect(headBack.pkgOut[1], valuesBack.pkgIn);
  connect(valuesBack.pkgOut[1], closingBack.pkgIn);

  when sample(0, step) then
    sequence = pre(sequence) + 1;
  end when;
  // START until an answer has come; the world answers a START that comes again.
  head.u = {magic, session, if newest < 0 then 0 else sequence, if newest < 0 then 1 else 0};
  values.u = {time, car.force};
  closing.u = {if newest < 0 then 0 else sequence};

  isGood = headBack.y[1] == magic and headBack.y[2] == session and headBack.y[3] == closingBack.y[1];
  // Half a step behind the datagrams' own sample: what they read is there.
  when sample(0.5 * step, step) then
    if isGood and headBack.y[3] > pre(newest) then
      newest = headBack.y[3];
      told = valuesBack.y;
      ignored = pre(ignored);
    else
      newest = pre(newest);
      told = pre(told);
      ignored = pre(ignored) + 1;
    end if;
  end when;
  car.place = told[2];
  car.speed = told[3];
  car.gap = told[4];
end OverUdp;
