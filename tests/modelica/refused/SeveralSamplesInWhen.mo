model SeveralSamplesInWhen
  output Integer n(start = 0, fixed = true);
equation
  when {sample(0, 0.2), sample(0, 0.3), initial()} then // refused: several samples
    n = pre(n) + 1;
  end when;
end SeveralSamplesInWhen;
