model TerminalEvent
  discrete Real d(start = 0, fixed = true);
  output Real y;
equation
  when terminal() then // refused: terminal
    d = 1;
  end when;
  y = d;
end TerminalEvent;
