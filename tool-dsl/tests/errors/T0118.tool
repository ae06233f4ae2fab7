tool Ball
