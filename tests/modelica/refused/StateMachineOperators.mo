model StateMachineOperators // refused: initialState
  block Start
    output Integer y(start = 0);
  equation
    y = previous(y) + 1;
  end Start;
  Start a;
  Start b;
  output Integer y;
equation
  initialState(a);
  transition(a, b, a.y > 3);
  y = a.y;
end StateMachineOperators;
