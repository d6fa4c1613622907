model CounterNamedAsVariable
  function f
    input Real x;
    output Real y;
  protected
    Integer j;
  algorithm
    j := 4;
    y := sum(j * x for j in 1:2) + j; // refused: the loop counter 'j'
  end f;
  input Real u(start = 1);
  output Real y = f(u);
end CounterNamedAsVariable;
