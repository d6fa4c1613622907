// A state machine of integers: conditions on the state before, guards on time and a state variable.
model StateMachine
  Integer state(start = 1, fixed = true);
  Real x(start = 0, fixed = true);
  discrete Real entered(start = 0, fixed = true);
  output Integer now;
  output Real y;
  output Real since;
equation
  der(x) = if state == 1 then 1 elseif state == 2 then -2 else 0;
  when pre(state) == 1 and x > 0.5 then
    state = 2;
    entered = time;
  elsewhen pre(state) == 2 and x < 0.1 then
    state = 3;
    entered = time;
  elsewhen pre(state) == 3 and time > pre(entered) + 0.3 then
    state = 1;
    entered = time;
  end when;
  now = state;
  y = x;
  since = time - entered;
end StateMachine;
