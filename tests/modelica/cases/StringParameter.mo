// A string parameter in a comparison, and one in the message of an assertion.
model StringParameter
  parameter String road = "dry";
  parameter String name = "tyre";
  output Real y;
equation
  y = if road == "dry" then 1 else 2;
  assert(y > 0, "the friction of " + name + " is lost");
end StringParameter;
