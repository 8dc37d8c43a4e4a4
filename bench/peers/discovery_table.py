def markdown(f): return ""
