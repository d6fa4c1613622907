model SpatialDistribution
  Real x(start = 0, fixed = true);
  Real a;
  Real b;
  output Real y;
equation
  der(x) = 1;
  (a, b) = spatialDistribution(1, 0, x, true, {0.0, 1.0}, {0.0, 0.0}); // refused: spatialDistribution
  y = a + b;
end SpatialDistribution;
