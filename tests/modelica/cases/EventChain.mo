// One event sets off the next and that another, in the same instant; counted by edge and change.
model EventChain
  Boolean a(start = false, fixed = true);
  Boolean b(start = false, fixed = true);
  Boolean c(start = false, fixed = true);
  Integer n(start = 0, fixed = true);
  Integer m(start = 0, fixed = true);
  output Integer links;
  output Integer rises;
  output Boolean done;
equation
  a = time > 0.4 and time < 0.8;
  when a then
    b = not pre(b);
  end when;
  when b then
    c = true;
    n = pre(n) + 1;
  end when;
  when {change(a), edge(c)} then
    m = pre(m) + 1;
  end when;
  links = n;
  rises = m;
  done = c;
end EventChain;
