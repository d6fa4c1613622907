within Tiny;
package Blocks "Signals"
end Blocks;
