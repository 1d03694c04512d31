source <(vesalius completion bash)
