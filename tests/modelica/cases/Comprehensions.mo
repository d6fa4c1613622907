// Comprehensions and reductions: in each other, with conditions, over ranges with steps and over enumerations.
package Comprehensions
  type Wheel = enumeration(left, right);
  model Test
    parameter Real table[2, 3] = {{1, 5, 2}, {4, 3, 6}};
    output Real largest = max(table[i, j] * (if i == j then 2 else 1) for i in 1:2, j in 1:3);
    output Real nested = sum(product(table[i, j] + time for j in 1:2:3) for i in 1:2);
    output Real rows[2] = {min(table[i, j] - i * time for j in 1:3) for i in 1:2};
    output Real wheels[2] = {sum(table[Integer(w), j] for j in 1:3) for w in Wheel};
  equation
  end Test;
end Comprehensions;
