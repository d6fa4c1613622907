// Outputs that are a constant, a parameter, an input, its opposite, time, a state and another output.
model OutputsOfEverything
  constant Real c = 4;
  parameter Real p = 5;
  input Real u(start = 6);
  input Integer n(start = 2);
  input Boolean b(start = true);
  Real x(start = 7, fixed = true);
  output Real of_constant = c;
  output Real of_parameter = p;
  output Real of_input = u;
  output Real of_opposite = -u;
  output Real of_time = time;
  output Real of_state = x;
  output Real of_output = of_state;
  output Integer of_integer = n;
  output Boolean of_boolean = b;
  output Real literal = 8;
equation
  der(x) = 1;
end OutputsOfEverything;
