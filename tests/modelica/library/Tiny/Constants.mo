within Tiny;
package Constants "Numbers of mathematics"
  final constant Real pi = 2 * asin(1.0);
end Constants;
