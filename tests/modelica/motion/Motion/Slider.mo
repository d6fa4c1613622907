within Motion;
model Slider "A body that passes a mark; its base is declared in it and has the position as well"
  extends Marked;
  parameter Real v = 2;
  encapsulated partial model Marked
    import Motion.Position;
    parameter Real mark = 1;
    Boolean is_behind = s > mark;
    extends Position;
  end Marked;
equation
  der(s) = v;
end Slider;
