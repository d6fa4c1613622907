within ;
package Tiny "A library in the manner of the Modelica Standard Library: a folder per package, a file per class"
  annotation(version = "1.0");
end Tiny;
