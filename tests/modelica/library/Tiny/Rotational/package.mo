within Tiny;
package Rotational "One-dimensional rotation"
end Rotational;
