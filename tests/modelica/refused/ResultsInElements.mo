package ResultsInElements
  function both
    input Real u;
    output Real p;
    output Real q;
  algorithm
    p := u;
    q := 10 * u;
  end both;
  function f // refused: several results of a function in elements of one array
    input Real x;
    output Real y[2];
  protected
    Real a[2];
  algorithm
    (a[1], a[2]) := both(x);
    y := a;
  end f;
  model Test
    input Real u(start = 1);
    output Real y[2] = f(u);
  end Test;
end ResultsInElements;
