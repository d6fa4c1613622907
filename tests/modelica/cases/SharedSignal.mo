// Connections of one discrete signal to elements of several vectors.
package SharedSignal
  connector IntegerOutput = output Integer;
  connector IntegerInput = input Integer;

  block Counter
    parameter Real period = 1;
    IntegerOutput y;
  equation
    y = integer(time/period);
  end Counter;

  block Sum
    parameter Integer n = 1;
    IntegerInput u[n];
    IntegerOutput y;
  equation
    y = sum(u);
  end Sum;

  block Product
    parameter Integer n = 1;
    IntegerInput u[n];
    IntegerOutput y;
  equation
    y = product(u);
  end Product;

  model Test
    Counter fast(period = 0.2);
    Counter slow(period = 0.45);
    Sum sum1(n = 3);
    Product product1(n = 2);
    output Integer total;
    output Integer square;
  equation
    connect(fast.y, sum1.u[1]);
    connect(slow.y, sum1.u[2]);
    connect(fast.y, sum1.u[3]);
    connect(slow.y, product1.u[1]);
    connect(sum1.y, product1.u[2]);
    total = sum1.y;
    square = product1.y;
  end Test;
end SharedSignal;
