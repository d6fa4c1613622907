// Every elementary function at once.
model MathFunctions
  input Real u(start = 0.3);
  input Real w(start = -1.7);
  output Real y[22];
equation
  y[1] = sin(u);
  y[2] = cos(u);
  y[3] = tan(u);
  y[4] = asin(u);
  y[5] = acos(u);
  y[6] = atan(w);
  y[7] = atan2(u, w);
  y[8] = sinh(w);
  y[9] = cosh(w);
  y[10] = tanh(w);
  y[11] = exp(w);
  y[12] = log(u);
  y[13] = log10(u);
  y[14] = sqrt(u);
  y[15] = abs(w);
  y[16] = sign(w);
  y[17] = min(u, w);
  y[18] = max(u, w);
  y[19] = u ^ 2.5;
  y[20] = w ^ 3;
  y[21] = w ^ (-2);
  y[22] = 2 ^ w;
end MathFunctions;
