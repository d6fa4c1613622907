model NestedWhen // refused: when-equations
  discrete Real d(start = 0, fixed = true);
  output Real y;
equation
  when time > 0.2 then
    when time > 0.3 then
      d = 1;
    end when;
  end when;
  y = d;
end NestedWhen;
