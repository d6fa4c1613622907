model ClockedPrevious
  input Real u(start = 1);
  Real x(start = 0);
  output Real y;
equation
  when Clock(0.1) then
    x = previous(x) + u; // refused: clocked when-clause
  end when;
  y = hold(x);
end ClockedPrevious;
