within Tiny.Interfaces;
connector RealInput = input Real "'input Real' as connector";
