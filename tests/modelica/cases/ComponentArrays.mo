// Arrays of components: modified with each, with one value per element, connected in loops, one element changed.
package ComponentArrays
  block Lag
    parameter Real T = 1;
    parameter Real k = 1;
    input Real u;
    output Real y;
    Real x(start = 0, fixed = true);
  equation
    T * der(x) = k * u - x;
    y = x;
  end Lag;
  model Test
    constant Integer n = 3;
    input Real u(start = 1);
    Lag lag[n](each k = 2, T = {0.5, 1, 0.25}, x(start = {1, 0, -1}));
    output Real y;
  equation
    lag[1].u = u;
    for i in 2:n loop
      connect(lag[i - 1].y, lag[i].u);
    end for;
    y = lag[n].y;
  end Test;
end ComponentArrays;
