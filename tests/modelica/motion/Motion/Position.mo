within Motion;
partial model Position
  Real s(start = 0, fixed = true);
end Position;
