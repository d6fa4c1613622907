within Tiny.Blocks;
block Limiter "Limit the range of a signal"
  parameter Real uMax(start = 1);
  parameter Real uMin = -uMax;
  Interfaces.RealInput u;
  Interfaces.RealOutput y;
equation
  assert(uMax >= uMin, "Limiter: Limits must be consistent");
  y = smooth(0, if u > uMax then uMax else if u < uMin then uMin else u);
end Limiter;
