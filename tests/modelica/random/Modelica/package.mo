package Modelica "Random numbers declared as in the Modelica Standard Library"
  package Math
    package Random
      package Generators
        package Xorshift64star
          constant Integer nState = 2;
          function initialState
            input Integer localSeed;
            input Integer globalSeed;
            output Integer state[nState];
          algorithm
            state := {localSeed, globalSeed};
          end initialState;
          pure function random
            input Integer stateIn[nState];
            output Real result;
            output Integer stateOut[nState];
            external "C" ModelicaRandom_xorshift64star(stateIn, stateOut, result);
          end random;
        end Xorshift64star;
        package Xorshift128plus
          constant Integer nState = 4;
          function initialState
            input Integer localSeed;
            input Integer globalSeed;
            output Integer state[nState];
          algorithm
            state := Utilities.initialStateWithXorshift64star(localSeed, globalSeed, size(state, 1));
          end initialState;
          pure function random
            input Integer stateIn[nState];
            output Real result;
            output Integer stateOut[nState];
            external "C" ModelicaRandom_xorshift128plus(stateIn, stateOut, result);
          end random;
        end Xorshift128plus;
        package Xorshift1024star
          constant Integer nState = 33;
          function initialState
            input Integer localSeed;
            input Integer globalSeed;
            output Integer state[nState];
          algorithm
            state := Utilities.initialStateWithXorshift64star(localSeed, globalSeed, size(state, 1));
          end initialState;
          pure function random
            input Integer stateIn[nState];
            output Real result;
            output Integer stateOut[nState];
            external "C" ModelicaRandom_xorshift1024star(stateIn, stateOut, result);
          end random;
        end Xorshift1024star;
      end Generators;
      package Utilities
        function automaticGlobalSeed
          output Integer seed;
          external "C" seed = ModelicaRandom_automaticGlobalSeed(0.0);
        end automaticGlobalSeed;
        function initializeImpureRandom
          input Integer seed;
          output Integer id;
        protected
          Integer rngState[33];
          impure function setInternalState
            input Integer[33] rngState;
            input Integer id;
            external "C" ModelicaRandom_setInternalState_xorshift1024star(rngState, size(rngState, 1), id);
          end setInternalState;
        algorithm
          id := 715827883;
          setInternalState(rngState, id);
        end initializeImpureRandom;
        impure function impureRandom
          input Integer id;
          output Real y;
          external "C" y = ModelicaRandom_impureRandom_xorshift1024star(id);
        end impureRandom;
      end Utilities;
    end Random;
  end Math;
  package Utilities
    pure function hashString
      input String string;
      output Integer hash;
      external "C" hash = ModelicaStrings_hashString(string);
    end hashString;
  end Utilities;
  package Noise
    model GlobalSeed
      parameter Boolean useAutomaticSeed = false;
      parameter Integer fixedSeed = 67867967;
      final parameter Integer seed(fixed = false);
      final parameter Integer id(fixed = false);
    initial equation
      seed = if useAutomaticSeed then Modelica.Math.Random.Utilities.automaticGlobalSeed() else fixedSeed;
      id = Modelica.Math.Random.Utilities.initializeImpureRandom(seed);
    end GlobalSeed;
    block Uniform "Draws from a state of its own"
      import generator = Modelica.Math.Random.Generators.Xorshift128plus;
      final parameter Integer local_seed(fixed = false);
      output Real y;
    protected
      outer GlobalSeed globalSeed;
      parameter Integer seed = globalSeed.seed;
      Integer state[generator.nState];
    initial equation
      local_seed = Modelica.Utilities.hashString(getInstanceName());
      pre(state) = generator.initialState(local_seed, seed);
      y = generator.random(pre(state));
    equation
      when sample(0.1, 0.1) then
        (y, state) = generator.random(pre(state));
      end when;
    end Uniform;
    block Impure "Draws from the generator with a hidden state"
      output Real y;
    protected
      outer GlobalSeed globalSeed;
    equation
      when {initial(), sample(0.1, 0.1)} then
        y = Modelica.Math.Random.Utilities.impureRandom(globalSeed.id);
      end when;
    end Impure;
  end Noise;
end Modelica;
