// fails at the start: VariableIndex.mo
model VariableIndex
  input Boolean locked(start = true);
  Real w1(start = 0);
  Real w2(start = 1);
  Real tau;
  output Real y;
equation
  der(w1) = tau;
  der(w2) = -tau;
  if locked then
    w1 = w2;
  else
    tau = 0;
  end if;
  y = w1;
end VariableIndex;
