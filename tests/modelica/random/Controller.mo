model Controller
  import Modelica.Math.Random.Generators;
  parameter Integer local_seed = 614657;
  output Real r64;
  output Real r128;
  output Real r1024;
  output Real hidden = hiding.y;
  output Integer hash = Modelica.Utilities.hashString("this is a test");
  output Integer name = noise1.local_seed;
  inner Modelica.Noise.GlobalSeed globalSeed;
  Modelica.Noise.Impure hiding;
  Modelica.Noise.Uniform noise1;
protected
  Integer s64[2];
  Integer s128[4];
  Integer s1024[33];
initial equation
  pre(s64) = Generators.Xorshift64star.initialState(local_seed, 30020);
  pre(s128) = Generators.Xorshift128plus.initialState(local_seed, 30020);
  pre(s1024) = Generators.Xorshift1024star.initialState(local_seed, 30020);
equation
  when sample(0, 0.1) then
    (r64, s64) = Generators.Xorshift64star.random(pre(s64));
    (r128, s128) = Generators.Xorshift128plus.random(pre(s128));
    (r1024, s1024) = Generators.Xorshift1024star.random(pre(s1024));
  end when;
end Controller;
