// Dry friction of a light mass that comes to rest: started to either side, it would be pushed back at once.
model FrictionThatCatches
  parameter Real m = 0.25;
  parameter Real limit = 1;
  Real w(start = -2, fixed = true);
  output Real y = w;
  output Integer mode(start = -1, fixed = true);
protected
  Real a = der(w);
  Real sa;
  Real friction;
  Boolean forward;
  Boolean backward;
  Boolean locked;
equation
  forward = pre(mode) == 0 and (sa > limit or pre(forward) and sa > limit);
  backward = pre(mode) == 0 and (sa < -limit or pre(backward) and sa < -limit);
  locked = not (pre(mode) == 1 or forward or pre(mode) == -1 or backward);
  a = if locked then 0 elseif pre(mode) == 1 or forward then sa - limit else sa + limit;
  friction = if locked then sa elseif pre(mode) == 1 or forward then limit else -limit;
  m*a = time - friction;
  mode = if (pre(mode) == 1 or forward) and w > 0 then 1 elseif (pre(mode) == -1 or backward) and w < 0 then -1 else 0;
end FrictionThatCatches;
