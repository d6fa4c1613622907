// The name of an instance: that of the simulated class, and the way to the instance.
package InstanceNames
  function place
    input String name;
    output Integer number;
  algorithm
    number := if name == "Test.left.part" then 1 elseif name == "Test.part" then 2 else 3;
  end place;
  model Part
    final parameter Integer which(fixed = false);
  initial equation
    which = place(getInstanceName());
  end Part;
  model Side
    Part part;
  end Side;
  model Test
    Side left;
    Part part;
    Part other;
    output Integer y[3] = {left.part.which, part.which, other.which};
  end Test;
end InstanceNames;
