within ;
package DseUdp "Modelica against a world outside: clients/modelica/README.md"
end DseUdp;
