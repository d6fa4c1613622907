// A sampled proportional-integral controller with a continuous plant; the input of the plant is held.
model SampledController
  parameter Real Ki = 2;
  parameter Real Kp = 0.5;
  constant Real Ts = 0.1;
  input Real wanted(start = 1);
  Real x(start = 0, fixed = true);
  discrete Real sum(start = 0, fixed = true);
  discrete Real u(start = 0, fixed = true);
  output Real y;
  output Real command;
equation
  der(x) = u - x;
  when sample(0, Ts) then
    sum = pre(sum) + Ts * (wanted - x);
    u = Kp * (wanted - x) + Ki * sum;
  end when;
  y = x;
  command = u;
end SampledController;
