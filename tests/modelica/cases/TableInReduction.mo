// A position that is a table of an angle, differentiated twice by the index reduction.
package TableInReduction
  function lookup
    input Real x;
    input Real xs[:];
    input Real ys[size(xs, 1)];
    input Integer smooth_curve;
    input Integer extrapolation;
    output Real y;
    external "C" y = dse_table1(x, xs, size(xs, 1), ys, smooth_curve, extrapolation);
  end lookup;
  model Test
    parameter Real xs[4] = {0, 1, 2, 4};
    parameter Real ys[4] = {0, 0.5, 2, 3};
    parameter Real m = 2;
    Real phi(start = 0.2, fixed = true, stateSelect = StateSelect.always);
    Real s;
    Real v;
    Real f;
    output Real force;
    output Real speed;
  equation
    der(phi) = 1.5;
    s = lookup(phi, xs, ys, 1, 1);
    der(s) = v;
    m * der(v) = f;
    force = f;
    speed = v;
  end Test;
end TableInReduction;
